#include "render/film/error_map.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/letters.h"
#include "render/film/png.h"

/* The scale: what its ends show. */
static const double least = 1e-3, most = 1;

static double luma_of(const struct orl_film *film, size_t pixel)
{
    const float *rgb = film->pixels[pixel];
    return orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
}

double orl_film_mean(const struct orl_film *film)
{
    const size_t n = (size_t)film->width * film->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += luma_of(film, i);
    return sum / (double)n;
}

double orl_film_relative_error(const struct orl_film *film, size_t pixel, double mean)
{
    const double error = film->errors[pixel];
    return error > 0 ? error / fmax(luma_of(film, pixel), 0.1 * mean) : 0;
}

/* ---- Smoothing ------------------------------------------------------------------------------- */

/* Whether two pixels differ by no more than chance would have it. */
static bool alike(const struct orl_film *film, size_t a, size_t b)
{
    const double off = luma_of(film, a) - luma_of(film, b);
    return fabs(off) <= 2 * hypot((double)film->errors[a], (double)film->errors[b]);
}

static float error_about(const struct orl_film *film, uint32_t x, uint32_t y)
{
    const uint32_t x0 = x > 0 ? x - 1 : 0, x1 = x + 1 < film->width ? x + 1 : x;
    const uint32_t y0 = y > 0 ? y - 1 : 0, y1 = y + 1 < film->height ? y + 1 : y;
    const size_t at = (size_t)y * film->width + x;
    double squares = 0, count = 0;
    for (uint32_t v = y0; v <= y1; v++)
        for (uint32_t u = x0; u <= x1; u++) {
            const size_t other = (size_t)v * film->width + u;
            if (!alike(film, at, other))
                continue;
            squares += (double)film->errors[other] * film->errors[other];
            count++;
        }
    return (float)sqrt(squares / count);
}

int orl_film_smooth_errors(struct orl_film *film)
{
    float *smooth = calloc((size_t)film->width * film->height, sizeof *smooth);
    if (!smooth)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            smooth[(size_t)y * film->width + x] = error_about(film, x, y);
    free(film->errors);
    film->errors = smooth;
    return 0;
}

/* ---- HDR ------------------------------------------------------------------------------------- */

int orl_film_write_error_hdr(const struct orl_film *film, const struct orl_view *view,
                             const char *path, struct orl_error *err)
{
    struct orl_film gray;
    int code = orl_film_init(&gray, film->width, film->height, err);
    if (code == 0) {
        for (size_t i = 0; i < (size_t)film->width * film->height; i++)
            for (int c = 0; c < 3; c++)
                gray.pixels[i][c] = film->errors[i];
        code = orl_film_write_hdr(&gray, view, path, err);
    }
    orl_film_done(&gray);
    return code;
}

/* ---- PNG ------------------------------------------------------------------------------------- */

/*
 * CIELAB: lightness from 14 to 91 in even steps, hue from violet by way of teal to yellow so that
 * steps differ alike, chroma as far as sRGB goes but 60 at most.
 */
void orl_error_color(double relative, unsigned char ret_srgb[3])
{
    static const unsigned char points[][3] = {
        {28, 18, 107},  {10, 44, 115},   {12, 65, 114},  {14, 84, 115}, {17, 103, 119},
        {20, 122, 121}, {23, 141, 117},  {28, 161, 106}, {69, 179, 96}, {119, 194, 94},
        {162, 208, 95}, {204, 220, 101}, {245, 232, 112}};
    enum { LAST = sizeof points / sizeof *points - 1 };
    const double share = relative > least ? log(relative / least) / log(most / least) : 0;
    const double at = LAST * fmin(share, 1);
    const int low = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        ret_srgb[c] = (unsigned char)lrint(points[low][c] +
                                           (at - low) * (points[low + 1][c] - points[low][c]));
}

/* The picture with its legend, in pixels. */
struct layout {
    uint32_t width, height; /* of all */
    double unit;            /* of the legend: a small letter's size grows with the picture */
};
enum { LEGEND_UNITS = 62, LEAST_UNITS = 270, UNITS_ACROSS = 640 };

static struct layout layout_of(const struct orl_film *film)
{
    const uint32_t side = film->width > film->height ? film->width : film->height;
    const double unit = fmax(1, (double)side / UNITS_ACROSS);
    const uint32_t across = (uint32_t)ceil(LEAST_UNITS * unit);
    return (struct layout){film->width > across ? film->width : across,
                           film->height + (uint32_t)ceil(LEGEND_UNITS * unit), unit};
}

/* On white. */
static void draw_pixels(const struct orl_film *film, const struct orl_raster *raster)
{
    const double mean = orl_film_mean(film);
    memset(raster->rgb, 0xff, 3 * (size_t)raster->width * raster->height);
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            orl_error_color(orl_film_relative_error(film, (size_t)y * film->width + x, mean),
                            raster->rgb + 3 * ((size_t)y * raster->width + x));
}

/* The legend's scale, in its units: from the left of the picture, and from its own top. */
enum { SCALE_LEFT = 12, SCALE_TOP = 32, SCALE_UNITS = 12 };

static double scale_right(const struct layout *layout)
{
    return fmin(layout->width / layout->unit, 400) - 16;
}

static void draw_colours(const struct orl_film *film, const struct layout *layout,
                         const struct orl_raster *raster)
{
    const size_t first = (size_t)lrint(SCALE_LEFT * layout->unit);
    const size_t last = (size_t)lrint(scale_right(layout) * layout->unit);
    const size_t top = film->height + (size_t)lrint(SCALE_TOP * layout->unit);
    const size_t bottom = film->height + (size_t)lrint((SCALE_TOP + SCALE_UNITS) * layout->unit);
    for (size_t y = top; y < bottom; y++)
        for (size_t x = first; x < last; x++) {
            const double share = ((double)(x - first) + 0.5) / (double)(last - first);
            orl_error_color(least * pow(most / least, share),
                            raster->rgb + 3 * (y * raster->width + x));
        }
}

/* The k-th of n values from below; they are put in another order (Hoare 1961). */
static double find_kth(double *values, size_t n, size_t k)
{
    size_t first = 0, last = n - 1;
    while (first < last) {
        const double pivot = values[first + (last - first) / 2];
        size_t low = first, high = last;
        for (;; low++, high--) {
            while (values[low] < pivot)
                low++;
            while (values[high] > pivot)
                high--;
            if (low >= high)
                break;
            const double swap = values[low];
            values[low] = values[high];
            values[high] = swap;
        }
        if (k <= high)
            last = high;
        else
            first = high + 1;
    }
    return values[k];
}

/* "median 1.4 %, 95 % of pixels below 6.1 %". Returns 0 or ORL_ERR_NOMEM. */
static int say_how_large(const struct orl_film *film, char *ret_text, size_t size)
{
    const size_t n = (size_t)film->width * film->height;
    const double mean = orl_film_mean(film);
    double *errors = calloc(n + 1, sizeof *errors);
    if (!errors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        errors[i] = 100 * orl_film_relative_error(film, i, mean);
    const double median = find_kth(errors, n, n / 2), high = find_kth(errors, n, (n - 1) * 19 / 20);
    snprintf(ret_text, size, "median %.2g %%, 95 %% of pixels below %.2g %%", median, high);
    free(errors);
    return 0;
}

/* The ticks below it. */
static void draw_ticks(const struct layout *layout, const struct orl_raster *raster,
                       const struct orl_pen *pen, double y)
{
    static const double ticks[] = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
    const double unit = layout->unit, x0 = SCALE_LEFT, x1 = scale_right(layout);
    struct orl_pen line = *pen;
    line.weight = unit;
    for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        const double x = unit * (x0 + (x1 - x0) * log(ticks[i] / least) / log(most / least));
        char text[16];
        snprintf(text, sizeof text, "%g", 100 * ticks[i]);
        orl_raster_line(raster, &line, x, y, x, y + 3 * unit);
        orl_letters_draw(raster, pen, x - orl_letters_width(text, pen->size) / 2, y + 13 * unit,
                         text);
    }
}

static int draw_legend(const struct orl_film *film, const struct layout *layout,
                       const struct orl_raster *raster)
{
    const double unit = layout->unit, top = film->height;
    const struct orl_pen pen = {.size = 7.5 * unit, .rgb = {26, 26, 26}};
    char text[96];
    const int code = say_how_large(film, text, sizeof text);
    if (code < 0)
        return code;
    orl_letters_draw(raster, &pen, 11 * unit, top + 12 * unit,
                     "Standard error, % of the pixel's luminance:");
    orl_letters_draw(raster, &pen, 11 * unit, top + 26 * unit, text);
    draw_ticks(layout, raster, &pen, top + (SCALE_TOP + SCALE_UNITS) * unit);
    return 0;
}

int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err)
{
    const struct layout layout = layout_of(film);
    const struct orl_raster raster = {malloc(3 * (size_t)layout.width * layout.height),
                                      layout.width, layout.height};
    int code = raster.rgb ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        draw_pixels(film, &raster);
        draw_colours(film, &layout, &raster);
        code = draw_legend(film, &layout, &raster);
    }
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing an error map");
    else
        code = orl_png_write(path, raster.width, raster.height, raster.rgb, err);
    free(raster.rgb);
    return code;
}
