#include "render/picture/false_color.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/statistics/numeric.h"

/* Ends of the scale. */
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

/* Returns true if two pixels differ by no more than their noise explains. */
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

static double share_of(double relative)
{
    return relative > least ? fmin(log(relative / least) / log(most / least), 1) : 0;
}

static void draw_pixels(const struct orl_film *film, const struct orl_sheet *sheet)
{
    const double mean = orl_film_mean(film);
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            orl_palette_color(
                ORL_PALETTE_EVEN,
                share_of(orl_film_relative_error(film, (size_t)y * film->width + x, mean)),
                orl_sheet_at(sheet, x, y));
}

/* Writes "median 1.4 %, 95 % of pixels below 6.1 %". Returns 0 or ORL_ERR_NOMEM. */
static int summarise_errors(const struct orl_film *film, char *ret_text, size_t size)
{
    const size_t n = (size_t)film->width * film->height;
    const double mean = orl_film_mean(film);
    double *errors = calloc(n + 1, sizeof *errors);
    if (!errors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        errors[i] = 100 * orl_film_relative_error(film, i, mean);
    const double median = orl_nth_element(errors, n, n / 2),
                 high = orl_nth_element(errors, n, (n - 1) * 19 / 20);
    snprintf(ret_text, size, "median %.2g %%, 95 %% of pixels below %.2g %%", median, high);
    free(errors);
    return 0;
}

static int draw_legend(const struct orl_film *film, const struct orl_sheet *sheet)
{
    static const double ticks[] = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
    char text[ORL_LEGEND_TEXT];
    struct orl_legend legend = {.lines = {"Standard error, % of the pixel's luminance:", text},
                                .palette = ORL_PALETTE_EVEN};
    for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        legend.ticks[i].at = share_of(ticks[i]);
        snprintf(legend.ticks[i].text, sizeof legend.ticks[i].text, "%g", 100 * ticks[i]);
        legend.n_ticks++;
    }
    const int code = summarise_errors(film, text, sizeof text);
    if (code == 0)
        orl_sheet_draw_legend(sheet, &legend);
    return code;
}

int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err)
{
    struct orl_sheet sheet;
    int code = orl_sheet_init(&sheet, film->width, film->height);
    if (code == 0) {
        draw_pixels(film, &sheet);
        code = draw_legend(film, &sheet);
    }
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing an error map");
    else
        code = orl_sheet_write(&sheet, path, err);
    orl_sheet_done(&sheet);
    return code;
}
