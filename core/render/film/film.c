#include "render/film/film.h"

#include <stdlib.h>
#include <string.h>

#include "base/io/out_file.h"

int orl_film_init(struct orl_film *film, uint32_t width, uint32_t height, struct orl_error *err)
{
    film->width = width;
    film->height = height;
    film->pixels = calloc((size_t)width * height, sizeof *film->pixels);
    film->errors = calloc((size_t)width * height, sizeof *film->errors);
    if (!film->pixels || !film->errors)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for an image of %u x %u", width,
                             height);
    return 0;
}

void orl_film_done(struct orl_film *film)
{
    free(film->pixels);
    free(film->errors);
    film->pixels = NULL;
    film->errors = NULL;
}

void orl_film_set(struct orl_film *film, uint32_t x, uint32_t y, const struct orl_pixel *pixel,
                  struct orl_health *health)
{
    const size_t at = (size_t)y * film->width + x;
    const struct orl_rgb color = pixel->value;
    float *rgb = film->pixels[at];
    /* A value beyond the range of floats becomes infinite before it is tested. */
    const struct orl_rgb held =
        orl_health_filter(health, (struct orl_rgb){(float)color.r, (float)color.g, (float)color.b});
    rgb[0] = (float)held.r;
    rgb[1] = (float)held.g;
    rgb[2] = (float)held.b;
    film->errors[at] = (float)pixel->standard_error;
}

bool orl_film_has_errors(const struct orl_film *film)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        if (!isfinite(film->errors[i]))
            return false;
    return true;
}

/* Scanlines outside these widths cannot be run-length encoded by component. */
enum {
    SHORTEST_RLE = 8,
    LONGEST_RLE = 32767,
    LEAST_RUN = 4,
    LONGEST_RUN = 127,
    LONGEST_DUMP = 128
};

void orl_rgbe_encode(const float rgb[3], unsigned char ret_rgbe[4])
{
    float clean[3], most = 0;
    uint32_t bits;
    for (int i = 0; i < 3; i++) {
        clean[i] = isfinite(rgb[i]) && rgb[i] > 0 ? rgb[i] : 0;
        most = fmaxf(most, clean[i]);
    }
    memset(ret_rgbe, 0, 4);
    if (most < 1e-32F)
        return;
    /* `most` is below 2^exponent, and at least half of that; it is not denormal. */
    memcpy(&bits, &most, sizeof bits);
    const int exponent = (int)(bits >> 23) - 126;
    const double scale = ldexp(256, -exponent);
    for (int i = 0; i < 3; i++)
        ret_rgbe[i] = (unsigned char)fmin(clean[i] * scale, 255);
    ret_rgbe[3] = (unsigned char)(exponent + 128);
}

/* Returns the length of the run of equal bytes at the start. */
static uint32_t run_length(const unsigned char *bytes, uint32_t count)
{
    uint32_t n = 1;
    while (n < count && n < LONGEST_RUN && bytes[n] == bytes[0])
        n++;
    return n;
}

/* Encodes one component of a scanline, as runs (128 + length, byte) and dumps (length, bytes).
 * Returns the end of the output: at most 1.5 times the input, and two bytes. */
static unsigned char *put_component(unsigned char *out, const unsigned char *bytes, uint32_t count)
{
    for (uint32_t at = 0; at < count;) {
        uint32_t run = run_length(bytes + at, count - at), dump = 0;
        if (run >= LEAST_RUN) {
            *out++ = (unsigned char)(128 + run);
            *out++ = bytes[at];
            at += run;
            continue;
        }
        while (at + dump < count && dump < LONGEST_DUMP) {
            run = run_length(bytes + at + dump, count - at - dump);
            if (run >= LEAST_RUN)
                break;
            dump += run;
        }
        dump = dump < LONGEST_DUMP ? dump : LONGEST_DUMP;
        *out++ = (unsigned char)dump;
        memcpy(out, bytes + at, dump);
        out += dump;
        at += dump;
    }
    return out;
}

/* Encodes a scanline. parts: one row of each component. Returns the number of bytes written. */
static size_t put_scanline(unsigned char *out, const unsigned char *parts, uint32_t width)
{
    unsigned char *end = out;
    if (width < SHORTEST_RLE || width > LONGEST_RLE) {
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < 4; c++)
                *end++ = parts[c * width + x];
        return (size_t)(end - out);
    }
    *end++ = 2;
    *end++ = 2;
    *end++ = (unsigned char)(width >> 8);
    *end++ = (unsigned char)(width & 255);
    for (uint32_t c = 0; c < 4; c++)
        end = put_component(end, parts + (size_t)c * width, width);
    return (size_t)(end - out);
}

static void write_scanline(FILE *stream, float (*const row)[3], uint32_t width,
                           unsigned char *scratch)
{
    unsigned char pixel[4], *const out = scratch + 4 * (size_t)width;
    for (uint32_t x = 0; x < width; x++) {
        orl_rgbe_encode(row[x], pixel);
        for (uint32_t c = 0; c < 4; c++)
            scratch[c * width + x] = pixel[c];
    }
    fwrite(out, 1, put_scanline(out, scratch, width), stream);
}

int orl_film_write_hdr(const struct orl_film *film, const struct orl_view *view, const char *path,
                       struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    char text[1024];
    unsigned char *scratch = malloc((size_t)film->width * 4 * 3 + 16); /* size: see put_component */
    int code = scratch ? orl_out_open(&file, path, err)
                       : orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an image");
    if (code == 0 && file.stream) {
        const double aspect = orl_view_pixel_aspect(view, film->width, film->height);
        orl_view_format(view, text, sizeof text);
        fprintf(file.stream, "#?RADIANCE\nSOFTWARE= Oriel\nVIEW= %s\n", text);
        if (fabs(aspect - 1) > 0.005)
            fprintf(file.stream, "PIXASPECT= %.6g\n", aspect);
        fprintf(file.stream, "FORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n", film->height, film->width);
        for (uint32_t y = 0; y < film->height; y++)
            write_scanline(file.stream, film->pixels + (size_t)y * film->width, film->width,
                           scratch);
        code = orl_out_close(&file, 0, err);
    }
    free(scratch);
    return code;
}
