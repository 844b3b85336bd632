#include <stdlib.h>
#include <string.h>

#include "render/file.h"
#include "render/film.h"

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
    int exponent;
    for (int i = 0; i < 3; i++) {
        clean[i] = isfinite(rgb[i]) && rgb[i] > 0 ? rgb[i] : 0;
        most = fmaxf(most, clean[i]);
    }
    memset(ret_rgbe, 0, 4);
    if (most < 1e-32F)
        return;
    const double scale = frexp((double)most, &exponent) * 256.0 / most;
    for (int i = 0; i < 3; i++)
        ret_rgbe[i] = (unsigned char)fmin(clean[i] * scale, 255);
    ret_rgbe[3] = (unsigned char)(exponent + 128);
}

/* Length of the run of equal bytes at the start. */
static uint32_t run_length(const unsigned char *bytes, uint32_t count)
{
    uint32_t n = 1;
    while (n < count && n < LONGEST_RUN && bytes[n] == bytes[0])
        n++;
    return n;
}

/* One component of a scanline, as runs (128 + length, byte) and dumps (length, bytes). */
static void write_component(FILE *stream, const unsigned char *bytes, uint32_t count)
{
    for (uint32_t at = 0; at < count;) {
        uint32_t run = run_length(bytes + at, count - at), dump = 0;
        if (run >= LEAST_RUN) {
            putc((int)(128 + run), stream);
            putc(bytes[at], stream);
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
        putc((int)dump, stream);
        fwrite(bytes + at, 1, dump, stream);
        at += dump;
    }
}

static void write_scanline(FILE *stream, float (*const row)[3], uint32_t width,
                           unsigned char *scratch)
{
    unsigned char pixel[4];
    for (uint32_t x = 0; x < width; x++) {
        orl_rgbe_encode(row[x], pixel);
        for (uint32_t c = 0; c < 4; c++)
            scratch[c * width + x] = pixel[c];
    }
    if (width < SHORTEST_RLE || width > LONGEST_RLE) {
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < 4; c++)
                putc(scratch[c * width + x], stream);
        return;
    }
    putc(2, stream);
    putc(2, stream);
    putc((int)(width >> 8), stream);
    putc((int)(width & 255), stream);
    for (uint32_t c = 0; c < 4; c++)
        write_component(stream, scratch + (size_t)c * width, width);
}

int orl_film_write_hdr(const struct orl_film *film, const struct orl_view *view, const char *path,
                       struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    char text[1024];
    unsigned char *scratch = malloc((size_t)film->width * 4);
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
