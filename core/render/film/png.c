/* PNG files, still and animated. */
#include "render/film/image_files.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include <oriel/job/picture.h>

#include "base/io/out_file.h"

struct picture {
    uint32_t width, height;
    const unsigned char *rgb;
    int bits; /* per channel */
};

/* Encodes a picture. libpng reports failure by a jump back to here. */
static int encode_png(const struct picture *picture, FILE *stream)
{
    errno = 0;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return orl_err_of_errno(errno);
    }
    png_init_io(png, stream);
    png_set_IHDR(png, info, picture->width, picture->height, picture->bits, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
    png_set_compression_strategy(png, Z_RLE);
    png_write_info(png, info);
    for (uint32_t y = 0; y < picture->height; y++)
        png_write_row(png, picture->rgb + (size_t)picture->bits / 8 * 3 * y * picture->width);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return 0;
}

static int write_picture(const struct picture *picture, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    code = encode_png(picture, file.stream);
    if (code < 0)
        orl_error_set(err, code, "libpng failed writing '%s'%s", path,
                      code == ORL_ERR_NOMEM ? ": out of memory" : "");
    return orl_out_close(&file, code, err);
}

int orl_png_write(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                  struct orl_error *err)
{
    const struct picture picture = {width, height, rgb, 8};
    return write_picture(&picture, path, err);
}

int orl_png_write_16(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                     struct orl_error *err)
{
    const struct picture picture = {width, height, rgb, 16};
    return write_picture(&picture, path, err);
}

/* ---- Animated PNG ---------------------------------------------------------------------------- */

enum { CHUNK = 1 << 16, CHANNELS = 3, PAETH = 4, THOUSANDTHS = 1000 };

struct orl_apng {
    struct orl_out_file file;
    uint32_t width, height, frames, added;
    uint32_t number;    /* number of the next fcTL or fdAT */
    bool poster;        /* true if there is one, or it is being written */
    bool plain;         /* true if the current picture goes to IDAT */
    uint16_t delay;     /* frame time, thousandths of a second */
    unsigned char *row; /* a filtered row, preceded by its filter type; owned */
    unsigned char *out; /* a chunk's data, with room for its number in front; owned */
};

/* ---- Chunks ---------------------------------------------------------------------------------- */

static void put_32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> (24 - 8 * i));
}

static void put_16(unsigned char *at, uint16_t value)
{
    at[0] = (unsigned char)(value >> 8);
    at[1] = (unsigned char)value;
}

static void write_chunk(struct orl_apng *apng, const char *type, const unsigned char *data,
                        size_t size)
{
    unsigned char head[8], tail[4];
    uLong sum = crc32(0, (const Bytef *)type, 4);
    if (size > 0)
        sum = crc32(sum, data, (uInt)size);
    put_32(head, (uint32_t)size);
    memcpy(head + 4, type, 4);
    put_32(tail, (uint32_t)sum);
    fwrite(head, 1, sizeof head, apng->file.stream);
    fwrite(data, 1, size, apng->file.stream);
    fwrite(tail, 1, sizeof tail, apng->file.stream);
}

static void write_start(struct orl_apng *apng)
{
    static const unsigned char signature[8] = {137, 'P', 'N', 'G', '\r', '\n', 26, '\n'};
    enum { BITS = 8, TRUE_COLOUR = 2 };
    unsigned char header[13] = {0}, frames[8] = {0}, perceptual[1] = {0};
    put_32(header, apng->width);
    put_32(header + 4, apng->height);
    header[8] = BITS;
    header[9] = TRUE_COLOUR;
    put_32(frames, apng->frames); /* number of repetitions follows: 0, for ever */
    fwrite(signature, 1, sizeof signature, apng->file.stream);
    write_chunk(apng, "IHDR", header, sizeof header);
    write_chunk(apng, "sRGB", perceptual, sizeof perceptual);
    write_chunk(apng, "acTL", frames, sizeof frames);
}

/* Writes the control chunk of a frame that replaces the whole picture. */
static void write_control(struct orl_apng *apng)
{
    unsigned char control[26] = {0};
    put_32(control, apng->number++);
    put_32(control + 4, apng->width);
    put_32(control + 8, apng->height);
    put_16(control + 20, apng->delay);
    put_16(control + 22, THOUSANDTHS);
    write_chunk(apng, "fcTL", control, sizeof control);
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

static unsigned char predict_byte(int left, int above, int corner)
{
    const int p = left + above - corner;
    const int a = abs(p - left), b = abs(p - above), c = abs(p - corner);
    return (unsigned char)(a <= b && a <= c ? left : b <= c ? above : corner);
}

/* Filters a row; above: the row before, NULL for the first. */
static void filter_row(unsigned char *out, const unsigned char *row, const unsigned char *above,
                       size_t size)
{
    out[0] = PAETH;
    for (size_t i = 0; i < size; i++) {
        const int left = i < CHANNELS ? 0 : row[i - CHANNELS], up = above ? above[i] : 0;
        const int corner = i < CHANNELS || !above ? 0 : above[i - CHANNELS];
        out[1 + i] = (unsigned char)(row[i] - predict_byte(left, up, corner));
    }
}

/* Writes the coder's output as a chunk. */
static void flush_chunk(struct orl_apng *apng, z_stream *coder)
{
    enum { NUMBER = 4 };
    const size_t size = CHUNK - coder->avail_out;
    if (size > 0 && apng->plain) {
        write_chunk(apng, "IDAT", apng->out + NUMBER, size);
    } else if (size > 0) {
        put_32(apng->out, apng->number++);
        write_chunk(apng, "fdAT", apng->out, size + NUMBER);
    }
    coder->next_out = apng->out + NUMBER;
    coder->avail_out = CHUNK;
}

static int code_rows(struct orl_apng *apng, z_stream *coder, const unsigned char *rgb)
{
    const size_t size = (size_t)CHANNELS * apng->width;
    int state = Z_OK;
    for (uint32_t y = 0; y < apng->height; y++) {
        const unsigned char *row = rgb + size * y;
        const bool last = y + 1 == apng->height;
        filter_row(apng->row, row, y > 0 ? row - size : NULL, size);
        coder->next_in = apng->row;
        coder->avail_in = (uInt)(size + 1);
        while (state == Z_OK && (coder->avail_in > 0 || last)) {
            state = deflate(coder, last ? Z_FINISH : Z_NO_FLUSH);
            if (coder->avail_out == 0 || state == Z_STREAM_END)
                flush_chunk(apng, coder);
        }
    }
    return state == Z_STREAM_END ? 0 : ORL_ERR_INTERNAL;
}

static int code_picture(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err)
{
    enum { WINDOW = 15, MEMORY = 8 };
    z_stream coder = {.next_out = apng->out + 4, .avail_out = CHUNK};
    if (deflateInit2(&coder, Z_DEFAULT_COMPRESSION, Z_DEFLATED, WINDOW, MEMORY, Z_RLE) != Z_OK)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an animation");
    const int code = code_rows(apng, &coder, rgb);
    deflateEnd(&coder);
    return code < 0 ? orl_error_set(err, code, "zlib failed writing an animation") : 0;
}

int orl_apng_put_poster(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err)
{
    if (apng->poster || apng->added > 0)
        return orl_error_set(err, ORL_ERR_INTERNAL,
                             "an animation's poster must come first, and only once");
    apng->poster = true;
    apng->plain = true;
    return code_picture(apng, rgb, err);
}

int orl_apng_add(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err)
{
    if (apng->added == apng->frames)
        return orl_error_set(err, ORL_ERR_INTERNAL,
                             "an animation has more frames than its header states");
    apng->plain = apng->added == 0 && !apng->poster;
    write_control(apng);
    const int code = code_picture(apng, rgb, err);
    apng->added++;
    return code;
}

/* ---- The file -------------------------------------------------------------------------------- */

static void free_all(struct orl_apng *apng)
{
    free(apng->row);
    free(apng->out);
    free(apng);
}

int orl_apng_open(const char *path, uint32_t width, uint32_t height, uint32_t frames,
                  double frame_s, struct orl_apng **ret_apng, struct orl_error *err)
{
    const double delay = fmin(fmax(frame_s * THOUSANDTHS, 1), UINT16_MAX);
    struct orl_apng *apng = calloc(1, sizeof *apng);
    if (!apng) {
        orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an animation");
        return ORL_ERR_NOMEM;
    }
    *apng = (struct orl_apng){
        .width = width, .height = height, .frames = frames, .delay = (uint16_t)lrint(delay)};
    apng->row = malloc((size_t)CHANNELS * width + 1);
    apng->out = malloc(CHUNK + 4);
    int code = apng->row && apng->out
                   ? 0
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an animation");
    if (code == 0)
        code = orl_out_open(&apng->file, path, err);
    if (code < 0) {
        free_all(apng);
        return code;
    }
    write_start(apng);
    *ret_apng = apng;
    return 0;
}

int orl_apng_close(struct orl_apng *apng, int code, struct orl_error *err)
{
    if (!apng)
        return code;
    if (code == 0 && apng->added < apng->frames)
        code = orl_error_set(err, ORL_ERR_INTERNAL, "an animation lacks %u of its %u frames",
                             apng->frames - apng->added, apng->frames);
    if (code == 0)
        write_chunk(apng, "IEND", apng->out, 0);
    code = orl_out_close(&apng->file, code, err);
    free_all(apng);
    return code;
}

struct frame {
    uint32_t width, height;
    unsigned char *rgb; /* owned */
};

static int read_picture(const char *path, struct frame *ret_picture, struct orl_error *err)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%s': %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    unsigned char *rgb = malloc(PNG_IMAGE_SIZE(image));
    if (!rgb) {
        png_image_free(&image);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for '%s'", path);
    }
    if (!png_image_finish_read(&image, NULL, rgb, 0, NULL)) {
        free(rgb);
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%s': %s", path, image.message);
    }
    *ret_picture = (struct frame){image.width, image.height, rgb};
    return 0;
}

static int add_frame(struct orl_apng *apng, const char *path, const struct frame *first,
                     struct orl_error *err)
{
    struct frame frame = {0};
    int code = read_picture(path, &frame, err);
    if (code < 0)
        return code;
    code = frame.width == first->width && frame.height == first->height
               ? orl_apng_add(apng, frame.rgb, err)
               : orl_error_set(err, ORL_ERR_RANGE, "'%s' has another size", path);
    free(frame.rgb);
    return code;
}

int orl_animation_write(const char *const *pictures, size_t count, double frame_s, const char *path,
                        struct orl_error *err)
{
    struct frame first = {0};
    struct orl_apng *apng = NULL;
    int code = read_picture(pictures[0], &first, err);
    if (code < 0)
        return code;
    code = orl_apng_open(path, first.width, first.height, (uint32_t)count, frame_s, &apng, err);
    free(first.rgb);
    if (code < 0)
        return code;
    for (size_t i = 0; i < count && code == 0; i++)
        code = add_frame(apng, pictures[i], &first, err);
    return orl_apng_close(apng, code, err);
}
