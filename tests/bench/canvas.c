#include "bench/canvas.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"

struct bench_canvas bench_canvas_new(int width, int height)
{
    const size_t size = 3 * (size_t)width * (size_t)height;
    struct bench_canvas canvas = {width, height, malloc(size)};
    if (!canvas.pixels)
        bench_fail("out of memory for a picture", NULL);
    memset(canvas.pixels, 255, size);
    return canvas;
}

void bench_canvas_done(struct bench_canvas *canvas)
{
    free(canvas->pixels);
    canvas->pixels = NULL;
}

static unsigned char to_srgb(double linear)
{
    const double c = fmin(fmax(linear, 0), 1);
    return (unsigned char)lrint(255 *
                                (c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055));
}

void bench_canvas_set(struct bench_canvas *canvas, int x, int y, const double rgb[3])
{
    unsigned char *pixel = canvas->pixels + 3 * ((size_t)y * (size_t)canvas->width + (size_t)x);
    for (int c = 0; c < 3; c++)
        pixel[c] = to_srgb(rgb[c]);
}

void bench_canvas_set_share(struct bench_canvas *canvas, int x, int y, double share)
{
    const double s = fmin(fmax(share, -1), 1);
    const double rgb[3] = {s < 0 ? 1 + s : 1, 1 - fabs(s), s > 0 ? 1 - s : 1};
    bench_canvas_set(canvas, x, y, rgb);
}

void bench_canvas_set_radiance(struct bench_canvas *canvas, int x, int y, const double rgb[3],
                               double average)
{
    static const double grey = 0.25, white = 10;
    const double luma = orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
    const double scaled = grey * luma / average;
    const double shown = scaled * (1 + scaled / (white * white)) / (1 + scaled);
    double color[3] = {0, 0, 0};
    for (int c = 0; c < 3 && luma > 0; c++)
        color[c] = rgb[c] / luma * shown;
    bench_canvas_set(canvas, x, y, color);
}

void bench_canvas_write(const struct bench_canvas *canvas, const char *path)
{
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)canvas->width,
                       .height = (png_uint_32)canvas->height,
                       .format = PNG_FORMAT_RGB};
    if (!png_image_write_to_file(&image, path, 0, canvas->pixels, 0, NULL))
        bench_fail("libpng could not write a picture", NULL);
}
