/*
 * The scale of a false-colour picture: pixel values in their unit, the range, and the levels of
 * contours.
 *
 * A value is luma times the multiplier. Its share of the scale, from 0 to 1 and beyond, is value /
 * top. On a logarithmic scale it is 1 + log10(value / top) / decades, but at least 0. If divisions
 * are given, levels are evenly spaced on the scale as in falsecolor, the first one division up;
 * otherwise they are round numbers.
 */
#ifndef ORL_RENDER_PICTURE_SCALE_H
#define ORL_RENDER_PICTURE_SCALE_H

#include <oriel/base/limits.h>
#include <oriel/job/picture.h>

#include "render/film/film.h"
#include "render/picture/legend.h"

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

#endif
