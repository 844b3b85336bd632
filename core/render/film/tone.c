/* Pictures to look at: a film's luminances compressed, then sRGB. */
#include <stdlib.h>

#include "render/film/film.h"
#include "render/film/png.h"

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

/*
 * sRGB's curve, to 8 bits: the least linear value of each byte, and the byte of every so many-th
 * part of 1, from where the search goes up.
 */
enum { PARTS = 1024 };
struct curve {
    double least[257];
    unsigned char byte[PARTS + 1];
};

static void make_curve(struct curve *curve)
{
    curve->least[0] = 0;
    curve->least[256] = INFINITY;
    for (int i = 1; i < 256; i++) {
        const double s = (i - 0.5) / 255;
        curve->least[i] = s <= 0.0404482362771082 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
    }
    for (int part = 0, byte = 0; part <= PARTS; part++) {
        while (curve->least[byte + 1] <= (double)part / PARTS)
            byte++;
        curve->byte[part] = (unsigned char)byte;
    }
}

static unsigned char to_srgb(const struct curve *curve, double linear)
{
    const double c = fmin(fmax(linear, 0), 1);
    unsigned char byte = curve->byte[(int)(c * PARTS)];
    while (curve->least[byte + 1] <= c)
        byte++;
    return byte;
}

static void tone_map(const struct curve *curve, const float rgb[3], double average,
                     unsigned char ret_pixel[3])
{
    const double y = luminance(rgb), scaled = key * y / average;
    const double mapped = scaled * (1 + scaled / (white * white * key * key)) / (1 + scaled);
    for (int c = 0; c < 3; c++)
        ret_pixel[c] = y > 0 ? to_srgb(curve, fmax(rgb[c], 0) / y * mapped) : 0;
}

int orl_film_write_png(const struct orl_film *film, const char *path, struct orl_error *err)
{
    const size_t n = (size_t)film->width * film->height;
    unsigned char *rgb = malloc(3 * n);
    struct curve curve;
    if (!rgb)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an image");
    const double average = log_average(film);
    make_curve(&curve);
    for (size_t i = 0; i < n; i++)
        tone_map(&curve, film->pixels[i], average, rgb + 3 * i);
    const int code = orl_png_write(path, film->width, film->height, rgb, err);
    free(rgb);
    return code;
}
