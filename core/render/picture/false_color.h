/* False colours: legends, scales, lines of equal value, maps of errors, and the pictures
 * themselves. */
#ifndef ORL_RENDER_PICTURE_FALSE_COLOR_H
#define ORL_RENDER_PICTURE_FALSE_COLOR_H

#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/limits.h>
#include <oriel/job/picture.h>

#include "base/text/stroke_font.h"
#include "render/film/film.h"
#include "render/picture/display.h"

/*
 * A picture with a legend below it: two lines of text, and a scale with ticks.
 *
 * Coordinates are pixels from the upper left. Letters scale with the picture: sizes of the legend
 * are in units, which are one pixel in pictures up to 640 pixels wide.
 */

struct orl_sheet {
    struct orl_raster raster; /* picture and legend; its pixels are owned */
    uint32_t width, height;   /* size of the picture, which is at the upper left */
    double unit;
};

enum { ORL_LEGEND_TICKS = 72, ORL_LEGEND_TEXT = 96 };

struct orl_legend {
    const char *lines[2]; /* above the scale; the second may be NULL */
    enum orl_palette palette;
    size_t n_ticks;
    struct {
        double at; /* position on the scale, 0..1 */
        char text[16];
    } ticks[ORL_LEGEND_TICKS]; /* from left to right; overlapping texts are omitted */
};

/* Makes a white sheet with room for the picture and its legend. Returns 0 or ORL_ERR_NOMEM; call
 * orl_sheet_done in either case. */
int orl_sheet_init(struct orl_sheet *sheet, uint32_t width, uint32_t height);
void orl_sheet_done(struct orl_sheet *sheet);

/* Returns the address of a pixel of the picture. */
unsigned char *orl_sheet_at(const struct orl_sheet *sheet, uint32_t x, uint32_t y);

void orl_sheet_draw_legend(const struct orl_sheet *sheet, const struct orl_legend *legend);

int orl_sheet_write(const struct orl_sheet *sheet, const char *path, struct orl_error *err);

/*
 * The scale of a false-colour picture: pixel values in their unit, the range, and the levels of
 * contours.
 *
 * A value is luma times the multiplier. Its share of the scale, from 0 to 1 and beyond, is value /
 * top. On a logarithmic scale it is 1 + log10(value / top) / decades, but at least 0. If divisions
 * are given, levels are evenly spaced on the scale as in falsecolor, the first one division up;
 * otherwise they are round numbers.
 */

struct orl_scale {
    double top, decades, multiplier;
    enum orl_palette palette;
    char unit[ORL_PICTURE_LABEL_MAX];
    double levels[ORL_LIMIT_DIVISIONS]; /* ascending, in the unit */
    size_t n_levels;
};

/* Makes a scale. Unless it is given, the top is the next 1, 2 or 5 times a power of ten above 99 of
 * 100 pixels. irradiance: the film holds W/m2. Returns 0 or ORL_ERR_NOMEM. */
int orl_scale_make(struct orl_scale *scale, const struct orl_film *film,
                   const struct orl_false_color *how, bool irradiance);

/* Makes a scale without a film; high: the value that the top must cover. */
void orl_scale_set(struct orl_scale *scale, const struct orl_false_color *how, const char *unit,
                   double high);

double orl_scale_value(const struct orl_scale *scale, const float rgb[3]);
double orl_scale_share(const struct orl_scale *scale, double value);

/* Returns the number of levels that a value reaches. */
size_t orl_scale_band(const struct orl_scale *scale, double value);

/* Returns a level's position in the palette, 0 to 1. */
double orl_scale_level_share(const struct orl_scale *scale, size_t level);

/* Formats a number for labels, with three digits. */
void orl_scale_text(double value, char ret_text[16]);

/* Sets the ticks and palette of a legend. */
void orl_scale_legend(const struct orl_scale *scale, struct orl_legend *legend);

/*
 * Draws lines of equal value over a picture, labelled with their values.
 *
 * Lines are found by marching squares between the pixels' centres (Lorensen and Cline 1987, in two
 * dimensions). Values are smoothed slightly so that noise draws no lines. Where values jump by more
 * than a step of the levels between pixels there is the edge of an object, and no line is drawn.
 */

/* Returns the pen of a level's lines and texts. */
typedef struct orl_pen (*orl_isoline_pen)(const struct orl_scale *scale, size_t level, double unit);

/* Draws lines over the upper left of a raster, where the film's picture is. Texts avoid the named
 * points. unit: pixels per legend unit. Returns 0 or ORL_ERR_NOMEM. */
int orl_isolines_draw(const struct orl_raster *raster, const struct orl_film *film,
                      const struct orl_scale *scale, const struct orl_false_color *how,
                      orl_isoline_pen pen, double unit);

/* Draws a text that is legible on any background, centred at (x, y): in the pen's colour, with a
 * rim of opposite lightness. */
void orl_letters_on_anything(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                             double y, const char *text);

/*
 * Error maps: the estimated errors of an image.
 *
 * The map shows each pixel's standard error of its luma: the expected distance from the result of
 * the same job with unlimited samples and photons. It contains the noise of photons and rays, as
 * the technique estimates it (render/backward/backward.h, render/image/image.h). It does not
 * contain light that a technique leaves out or blurs for any seed.
 *
 * As HDR: gray, W/sr/m2, the same view and format as the image. As PNG: in false colours, relative
 * to the pixel or to a tenth of the image's mean, if that is more. (A dark pixel's error is
 * invisible next to bright ones; oriel/job/study.h uses the same measure.) Colours go in even steps
 * of lightness from 0.1 % to 100 %, the same for all images. A legend below shows them with the
 * median and 95th percentile of this image. Pixels without any error get the darkest colour.
 */

/*
 * Smooths errors estimated from few samples: a pixel's squared error becomes the mean of those of
 * the 3 x 3 pixels about it. Neighbours that differ by more than two standard errors show another
 * object and are left out. A rare bright sample in one pixel could also occur in its neighbours.
 * With n groups of samples a single estimate of the variance is off by sqrt(2 / (n - 1)). The mean
 * of nine is off by a third of that. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_film_smooth_errors(struct orl_film *film);

/* Returns the relative error of a pixel, as above. mean: orl_film_mean. */
double orl_film_relative_error(const struct orl_film *film, size_t pixel, double mean);
double orl_film_mean(const struct orl_film *film); /* mean luma of the pixels */

/* Write the map like orl_film_write_hdr and orl_png_write. The errors must be known. */
int orl_film_write_error_hdr(const struct orl_film *film, const struct orl_view *view,
                             const char *path, struct orl_error *err);
int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err);

/*
 * A film's luminances, or illuminances if it holds irradiances, in false colours with a legend; and
 * their contours over the tone-mapped picture. The results match Radiance's falsecolor on the same
 * film: -s -l -n -log -m -e -pal, -cl and -cb.
 */

/* Writes one of ORL_PICTURE_FALSE, _LINES and _BANDS as PNG. shown is required for the latter two.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_false_color_write(const struct orl_film *film, const struct orl_tonemapped *tonemapped,
                          const struct orl_scale *scale, const struct orl_false_color *how,
                          enum orl_picture picture, const char *path, struct orl_error *err);

/* Returns the value of the pixel at a point of the picture, in the scale's unit. */
double orl_false_color_at(const struct orl_film *film, const struct orl_scale *scale, double x,
                          double y);

#endif
