#include <errno.h>
#include <png.h>
#include <stdlib.h>

#include "render/file.h"
#include "render/film.h"

/* Middle grey of the picture, and the luminance (times the average) that comes out white. */
static const double key = 0.18, white = 60.0;

static double luminance(const float rgb[3])
{
    const double y = orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
    return isfinite(y) && y > 0 ? y : 0;
}

static double log_average(const struct orl_film *film)
{
    const size_t n = (size_t)film->width * film->height;
    double sum = 0, lit = 0;
    for (size_t i = 0; i < n; i++) {
        const double y = luminance(film->pixels[i]);
        if (y > 0) {
            sum += log(y);
            lit++;
        }
    }
    return lit > 0 ? exp(sum / lit) : 1;
}

static unsigned char to_srgb(double linear)
{
    const double c = fmin(fmax(linear, 0), 1);
    const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
    return (unsigned char)lrint(255 * s);
}

static void tone_map(const float rgb[3], double average, unsigned char ret_pixel[3])
{
    const double y = luminance(rgb), scaled = key * y / average;
    const double mapped = scaled * (1 + scaled / (white * white * key * key)) / (1 + scaled);
    for (int c = 0; c < 3; c++)
        ret_pixel[c] = y > 0 ? to_srgb(fmax(rgb[c], 0) / y * mapped) : 0;
}

/* libpng reports failure by jumping back here. */
static int encode(const struct orl_film *film, FILE *stream, unsigned char *row, double average)
{
    errno = 0;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return orl_err_of_errno(errno);
    }
    png_init_io(png, stream);
    png_set_IHDR(png, info, film->width, film->height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t y = 0; y < film->height; y++) {
        for (uint32_t x = 0; x < film->width; x++)
            tone_map(film->pixels[(size_t)y * film->width + x], average, row + 3 * (size_t)x);
        png_write_row(png, row);
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return 0;
}

int orl_film_write_png(const struct orl_film *film, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    unsigned char *row = malloc((size_t)film->width * 3);
    int code = row ? orl_out_open(&file, path, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an image");
    if (code == 0 && file.stream) {
        code = encode(film, file.stream, row, log_average(film));
        if (code < 0)
            orl_error_set(err, code, "libpng failed writing '%s'", path);
        code = orl_out_close(&file, code, err);
    }
    free(row);
    return code;
}
