#include "render/picture/legend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/png.h"

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

void orl_legend_draw(const struct orl_raster *raster, const struct orl_legend *legend, double unit,
                     double left, double top, double width)
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
