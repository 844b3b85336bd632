#include "render/picture/false_color.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double value_at(const struct orl_film *film, const struct orl_scale *scale, uint32_t x,
                       uint32_t y)
{
    return orl_scale_value(scale, film->pixels[(size_t)y * film->width + x]);
}

double orl_false_color_at(const struct orl_film *film, const struct orl_scale *scale, double x,
                          double y)
{
    const uint32_t px = (uint32_t)fmin(fmax(x, 0), film->width - 1.0);
    const uint32_t py = (uint32_t)fmin(fmax(y, 0), film->height - 1.0);
    return value_at(film, scale, px, py);
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

static void draw_fill(const struct orl_film *film, const struct orl_scale *scale,
                      const struct orl_sheet *sheet)
{
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            orl_palette_color(scale->palette, orl_scale_share(scale, value_at(film, scale, x, y)),
                              orl_sheet_at(sheet, x, y));
}

static int draw_tonemapped(const struct orl_tonemapped *tonemapped, const struct orl_sheet *sheet)
{
    const uint32_t width = sheet->width, height = sheet->height;
    unsigned char *rgb = malloc(3 * (size_t)width * height);
    if (!rgb)
        return ORL_ERR_NOMEM;
    orl_tonemapped_bytes(tonemapped, rgb);
    for (uint32_t y = 0; y < height; y++)
        memcpy(orl_sheet_at(sheet, 0, y), rgb + 3 * (size_t)y * width, 3 * (size_t)width);
    free(rgb);
    return 0;
}

/* Draws bands about the levels, each a tenth of the step to the next levels wide to either side. */
static void draw_bands(const struct orl_film *film, const struct orl_scale *scale,
                       const struct orl_sheet *sheet)
{
    double shares[ORL_LIMIT_DIVISIONS];
    for (size_t i = 0; i < scale->n_levels; i++)
        shares[i] = orl_scale_share(scale, scale->levels[i]);
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) {
            const double share = orl_scale_share(scale, value_at(film, scale, x, y));
            for (size_t i = 0; i < scale->n_levels; i++) {
                const double below = shares[i] - (i > 0 ? shares[i - 1] : 0);
                const double above = i + 1 < scale->n_levels ? shares[i + 1] - shares[i] : below;
                if (share > shares[i] - 0.1 * below && share < shares[i] + 0.1 * above)
                    orl_palette_color(scale->palette, orl_scale_level_share(scale, i),
                                      orl_sheet_at(sheet, x, y));
            }
        }
}

/* ---- Lines and marks ------------------------------------------------------------------------- */

enum { TEXT_UNITS = 8 };

/* Returns a pen for lines on false colours: black on light, white on dark. */
static struct orl_pen plain_pen(const struct orl_scale *scale, size_t level, double unit)
{
    unsigned char under[3];
    orl_palette_color(scale->palette, orl_scale_share(scale, scale->levels[level]), under);
    const bool dark = 3 * under[0] + 6 * under[1] + under[2] < 1000;
    struct orl_pen pen = {.size = TEXT_UNITS * unit, .weight = 1.2 * unit};
    memset(pen.rgb, dark ? 255 : 20, 3);
    return pen;
}

/* Returns a pen for lines on the picture: in the level's colour. */
static struct orl_pen colored_pen(const struct orl_scale *scale, size_t level, double unit)
{
    struct orl_pen pen = {.size = TEXT_UNITS * unit, .weight = 1.8 * unit};
    orl_palette_color(scale->palette, orl_scale_level_share(scale, level), pen.rgb);
    return pen;
}

static void draw_mark(const struct orl_sheet *sheet, double x, double y, const char *text)
{
    const double unit = sheet->unit, arm = 4 * unit;
    struct orl_pen pen = {.size = TEXT_UNITS * unit, .weight = 3 * unit, .rgb = {255, 255, 255}};
    for (int i = 0; i < 2; i++) {
        orl_raster_line(&sheet->raster, &pen, x - arm, y, x + arm, y);
        orl_raster_line(&sheet->raster, &pen, x, y - arm, x, y + arm);
        pen.weight = 1.4 * unit;
        memset(pen.rgb, 20, 3);
    }
    pen.weight = 0;
    const double half = orl_stroke_text_width(text, pen.size) / 2, gap = 4 * unit;
    const bool right = x + arm + gap + 2 * half < sheet->width;
    const double middle = right ? x + arm + gap + half : x - arm - gap - half;
    orl_letters_on_anything(&sheet->raster, &pen, middle,
                            fmin(fmax(y, pen.size), sheet->height - pen.size), text);
}

static void mark_points(const struct orl_film *film, const struct orl_scale *scale,
                        const struct orl_false_color *how, const struct orl_sheet *sheet)
{
    for (uint32_t i = 0; i < how->n_points; i++) {
        const struct orl_picture_point *p = &how->points[i];
        char number[16], text[ORL_PICTURE_LABEL_MAX + 20];
        orl_scale_text(orl_false_color_at(film, scale, p->x, p->y), number);
        snprintf(text, sizeof text, "%s %s", p->name, number);
        draw_mark(sheet, p->x, p->y, text);
    }
}

static void mark_extrema(const struct orl_film *film, const struct orl_scale *scale,
                         const struct orl_sheet *sheet)
{
    size_t least = 0, most = 0;
    const size_t n = (size_t)film->width * film->height;
    for (size_t i = 1; i < n; i++) {
        const double value = orl_scale_value(scale, film->pixels[i]);
        least = value < orl_scale_value(scale, film->pixels[least]) ? i : least;
        most = value > orl_scale_value(scale, film->pixels[most]) ? i : most;
    }
    const size_t at[] = {least, most};
    for (int i = 0; i < 2; i++) {
        char text[16];
        orl_scale_text(orl_scale_value(scale, film->pixels[at[i]]), text);
        const size_t y = at[i] / film->width;
        draw_mark(sheet, (double)(at[i] % film->width) + 0.5, (double)y + 0.5, text);
    }
}

static void draw_legend(const struct orl_scale *scale, const struct orl_false_color *how,
                        enum orl_picture picture, const struct orl_sheet *sheet)
{
    const bool lux = strcmp(scale->unit, "lx") == 0, nits = strcmp(scale->unit, "cd/m2") == 0;
    char title[ORL_LEGEND_TEXT], kind[ORL_LEGEND_TEXT];
    struct orl_legend legend = {.lines = {title, kind}};
    snprintf(title, sizeof title, "%s, %s",
             lux    ? "Illuminance"
             : nits ? "Luminance"
                    : "Values",
             scale->unit);
    snprintf(kind, sizeof kind, "%s%s", scale->decades > 0 ? "logarithmic" : "linear",
             picture == ORL_PICTURE_FALSE   ? how->isolines ? ", with lines of equal value" : ""
             : picture == ORL_PICTURE_LINES ? ", as lines of equal value"
                                            : ", as bands of equal value");
    orl_scale_legend(scale, &legend);
    orl_sheet_draw_legend(sheet, &legend);
}

static int draw_picture(const struct orl_film *film, const struct orl_tonemapped *tonemapped,
                        const struct orl_scale *scale, const struct orl_false_color *how,
                        enum orl_picture picture, const struct orl_sheet *sheet)
{
    int code = 0;
    if (picture == ORL_PICTURE_FALSE)
        draw_fill(film, scale, sheet);
    else
        code = draw_tonemapped(tonemapped, sheet);
    if (code == 0 && picture == ORL_PICTURE_BANDS)
        draw_bands(film, scale, sheet);
    if (code == 0 && picture == ORL_PICTURE_LINES)
        code = orl_isolines_draw(&sheet->raster, film, scale, how, colored_pen, sheet->unit);
    if (code == 0 && picture == ORL_PICTURE_FALSE && how->isolines)
        code = orl_isolines_draw(&sheet->raster, film, scale, how, plain_pen, sheet->unit);
    if (code == 0 && how->extrema)
        mark_extrema(film, scale, sheet);
    if (code == 0) {
        mark_points(film, scale, how, sheet);
        draw_legend(scale, how, picture, sheet);
    }
    return code;
}

int orl_false_color_write(const struct orl_film *film, const struct orl_tonemapped *tonemapped,
                          const struct orl_scale *scale, const struct orl_false_color *how,
                          enum orl_picture picture, const char *path, struct orl_error *err)
{
    struct orl_sheet sheet;
    int code = orl_sheet_init(&sheet, film->width, film->height);
    if (code == 0)
        code = draw_picture(film, tonemapped, scale, how, picture, &sheet);
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing false colours");
    else
        code = orl_sheet_write(&sheet, path, err);
    orl_sheet_done(&sheet);
    return code;
}
