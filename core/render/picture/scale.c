/* Sheets with legends, and the scales of false-colour pictures. */
#include "render/picture/false_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "base/statistics/numeric.h"
#include "render/film/image_files.h"

enum { LEGEND_UNITS = 62, LEAST_UNITS = 270, MOST_UNITS = 400, UNITS_ACROSS = 640 };

int orl_sheet_init(struct orl_sheet *sheet, uint32_t width, uint32_t height)
{
    const double unit = fmax(1, (double)(width > height ? width : height) / UNITS_ACROSS);
    const uint32_t least = (uint32_t)ceil(LEAST_UNITS * unit);
    *sheet = (struct orl_sheet){.width = width, .height = height, .unit = unit};
    sheet->raster.width = width > least ? width : least;
    sheet->raster.height = height + (uint32_t)ceil(LEGEND_UNITS * unit);
    const size_t bytes = 3 * (size_t)sheet->raster.width * sheet->raster.height;
    sheet->raster.rgb = malloc(bytes);
    if (!sheet->raster.rgb)
        return ORL_ERR_NOMEM;
    memset(sheet->raster.rgb, 0xff, bytes);
    return 0;
}

void orl_sheet_done(struct orl_sheet *sheet)
{
    free(sheet->raster.rgb);
    sheet->raster.rgb = NULL;
}

unsigned char *orl_sheet_at(const struct orl_sheet *sheet, uint32_t x, uint32_t y)
{
    return sheet->raster.rgb + 3 * ((size_t)y * sheet->raster.width + x);
}

/* ---- Legend ---------------------------------------------------------------------------------- */

/* Positions in units, from the left and from the legend's top. */
enum { TEXT_LEFT = 11, SCALE_LEFT = 12, SCALE_TOP = 32, SCALE_UNITS = 12 };

/* Bounds of the scale, in pixels. */
struct bar {
    size_t left, right, top, bottom;
};

static void draw_colours(const struct orl_raster *raster, enum orl_palette palette,
                         const struct bar *bar)
{
    for (size_t y = bar->top; y < bar->bottom && y < raster->height; y++)
        for (size_t x = bar->left; x < bar->right && x < raster->width; x++)
            orl_palette_color(palette,
                              ((double)(x - bar->left) + 0.5) / (double)(bar->right - bar->left),
                              raster->rgb + 3 * (y * raster->width + x));
}

static void draw_ticks(const struct orl_raster *raster, const struct orl_legend *legend,
                       double unit, const struct bar *bar, const struct orl_pen *pen)
{
    struct orl_pen line = *pen;
    double free_from = 0;
    line.weight = unit;
    for (size_t i = 0; i < legend->n_ticks; i++) {
        const double x = (double)bar->left + legend->ticks[i].at * (double)(bar->right - bar->left);
        const double y = (double)bar->bottom;
        const double width = orl_stroke_text_width(legend->ticks[i].text, pen->size);
        orl_raster_line(raster, &line, x, y, x, y + 3 * unit);
        const double start = fmin(x - width / 2, raster->width - width - 2 * unit);
        if (start < free_from)
            continue;
        orl_stroke_text_draw(raster, pen, start, y + 13 * unit, legend->ticks[i].text);
        free_from = start + width + 4 * unit;
    }
}

/* Draws a legend at a position; left, top and width in pixels. */
static void orl_legend_draw(const struct orl_raster *raster, const struct orl_legend *legend,
                            double unit, double left, double top, double width)
{
    const struct orl_pen pen = {.size = 7.5 * unit, .rgb = {26, 26, 26}};
    const struct bar bar = {.left = (size_t)lrint(left + SCALE_LEFT * unit),
                            .right = (size_t)lrint(left + width - 16 * unit),
                            .top = (size_t)lrint(top + SCALE_TOP * unit),
                            .bottom = (size_t)lrint(top + (SCALE_TOP + SCALE_UNITS) * unit)};
    for (int i = 0; i < 2; i++)
        if (legend->lines[i])
            orl_stroke_text_draw(raster, &pen, left + TEXT_LEFT * unit, top + (12 + 14 * i) * unit,
                                 legend->lines[i]);
    draw_colours(raster, legend->palette, &bar);
    draw_ticks(raster, legend, unit, &bar, &pen);
}

void orl_sheet_draw_legend(const struct orl_sheet *sheet, const struct orl_legend *legend)
{
    orl_legend_draw(&sheet->raster, legend, sheet->unit, 0, sheet->height,
                    fmin(sheet->raster.width, MOST_UNITS * sheet->unit));
}

int orl_sheet_write(const struct orl_sheet *sheet, const char *path, struct orl_error *err)
{
    return orl_png_write(path, sheet->raster.width, sheet->raster.height, sheet->raster.rgb, err);
}

double orl_scale_value(const struct orl_scale *scale, const float rgb[3])
{
    const double luma = orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
    return isfinite(luma) ? scale->multiplier * luma : 0;
}

double orl_scale_share(const struct orl_scale *scale, double value)
{
    const double part = value / scale->top;
    if (!(scale->decades > 0))
        return part;
    return part > pow(10, -scale->decades) ? 1 + log10(part) / scale->decades : 0;
}

/* ---- The top --------------------------------------------------------------------------------- */

/* Rounds up to 1, 2 or 5 times a power of ten. */
static double round_up(double value)
{
    const double power = pow(10, floor(log10(value)));
    const double digits = value / power;
    return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

/* Returns the value that 99 of 100 pixels stay below. */
static int find_high(const struct orl_scale *scale, const struct orl_film *film, double *ret_high)
{
    const size_t n = (size_t)film->width * film->height;
    double *values = calloc(n + 1, sizeof *values);
    if (!values)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        values[i] = orl_scale_value(scale, film->pixels[i]);
    *ret_high = orl_nth_element(values, n, (n - 1) - (n - 1) / 100);
    free(values);
    return 0;
}

/* ---- Levels ---------------------------------------------------------------------------------- */

static void set_even_levels(struct orl_scale *scale, uint32_t divisions)
{
    for (uint32_t i = 1; i <= divisions && scale->n_levels < ORL_LIMIT_DIVISIONS; i++) {
        const double share = (double)i / divisions;
        scale->levels[scale->n_levels++] =
            scale->top * (scale->decades > 0 ? pow(10, (share - 1) * scale->decades) : share);
    }
}

/* Sets levels at 1, 2, 5 of every decade, or at 1 alone if there are many decades. */
static void step_by_decades(struct orl_scale *scale)
{
    static const double digits[] = {1, 2, 5};
    const int per_decade = scale->decades > 3 ? 1 : 3;
    const double low = scale->top * pow(10, -scale->decades), hair = 1e-9;
    const int first = (int)floor(log10(low)), last = (int)ceil(log10(scale->top));
    for (int power = first; power <= last; power++)
        for (int i = 0; i < per_decade; i++) {
            const double level = digits[i] * pow(10, power);
            if (level > low * (1 + hair) && level <= scale->top * (1 + hair) &&
                scale->n_levels < ORL_LIMIT_DIVISIONS)
                scale->levels[scale->n_levels++] = level;
        }
}

/* Sets about five to ten levels in steps of 1, 2 or 5. */
static void step_evenly(struct orl_scale *scale)
{
    const double step = round_up(scale->top / 10 * (1 - 1e-9)), hair = 1e-9;
    for (int i = 1; i * step <= scale->top * (1 + hair); i++)
        scale->levels[scale->n_levels++] = i * step;
}

void orl_scale_set(struct orl_scale *scale, const struct orl_false_color *how, const char *unit,
                   double high)
{
    scale->decades = how->decades;
    scale->palette = how->palette;
    scale->n_levels = 0;
    scale->top = how->scale > 0 ? how->scale : high > 1e-30 && high < 1e30 ? round_up(high) : 1;
    snprintf(scale->unit, sizeof scale->unit, "%s", how->label[0] ? how->label : unit);
    if (how->divisions > 0)
        set_even_levels(scale, how->divisions);
    else if (scale->decades > 0)
        step_by_decades(scale);
    else
        step_evenly(scale);
}

int orl_scale_make(struct orl_scale *scale, const struct orl_film *film,
                   const struct orl_false_color *how, bool irradiance)
{
    double high = 0;
    *scale = (struct orl_scale){.multiplier =
                                    how->multiplier > 0 ? how->multiplier : ORL_EFFICACY_LM_PER_W};
    if (!(how->scale > 0) && find_high(scale, film, &high) < 0)
        return ORL_ERR_NOMEM;
    orl_scale_set(scale, how, irradiance ? "lx" : "cd/m2", high);
    return 0;
}

size_t orl_scale_band(const struct orl_scale *scale, double value)
{
    size_t band = 0;
    while (band < scale->n_levels && value >= scale->levels[band])
        band++;
    return band;
}

double orl_scale_level_share(const struct orl_scale *scale, size_t level)
{
    return scale->n_levels > 1 ? (double)level / (double)(scale->n_levels - 1) : 1;
}

/* ---- Legend ---------------------------------------------------------------------------------- */

void orl_scale_text(double value, char ret_text[16])
{
    const double size = fabs(value);
    if (size >= 999.5 && size < 1e7)
        snprintf(ret_text, 16, "%.0f", value < 1e4 ? value : round(value / 10) * 10);
    else
        snprintf(ret_text, 16, "%.3g", value);
}

void orl_scale_legend(const struct orl_scale *scale, struct orl_legend *legend)
{
    const double low = scale->decades > 0 ? scale->top * pow(10, -scale->decades) : 0;
    legend->palette = scale->palette;
    legend->n_ticks = 1;
    legend->ticks[0].at = 0;
    orl_scale_text(low, legend->ticks[0].text);
    for (size_t i = 0; i < scale->n_levels && legend->n_ticks < ORL_LEGEND_TICKS; i++) {
        const size_t at = legend->n_ticks++;
        legend->ticks[at].at = fmin(orl_scale_share(scale, scale->levels[i]), 1);
        orl_scale_text(scale->levels[i], legend->ticks[at].text);
    }
}
