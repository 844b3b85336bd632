/*
 * What a picture in false colours shows: values of pixels in their unit, a scale for them, and the
 * levels of its contours.
 *
 * A value is luma times the multiplier. Its share of the scale, 0 to 1 and beyond, is value / top,
 * or of a logarithmic scale 1 + log10(value / top) / decades, 0 below. With divisions given levels
 * are evenly spaced on the scale, as falsecolor has them, the first one division up; without, they
 * are round numbers.
 */
#ifndef ORL_RENDER_PICTURE_SCALE_H
#define ORL_RENDER_PICTURE_SCALE_H

#include <oriel/limits.h>
#include <oriel/picture.h>

#include "render/film/film.h"
#include "render/picture/legend.h"

struct orl_scale {
    double top, decades, multiplier;
    enum orl_palette palette;
    char unit[ORL_PICTURE_LABEL_MAX];
    double levels[ORL_LIMIT_DIVISIONS]; /* ascending, in the unit */
    size_t n_levels;
};

/* A scale that is found has the next 1, 2 or 5 times a power of ten as its top, from what 99 of 100
 * pixels stay below. irradiance: the film holds W/m2. Returns 0 or ORL_ERR_NOMEM. */
int orl_scale_make(struct orl_scale *scale, const struct orl_film *film,
                   const struct orl_false_color *how, bool irradiance);

/* The same without a film: its top is that of the values, of which n are below. */
void orl_scale_set(struct orl_scale *scale, const struct orl_false_color *how, const char *unit,
                   double high);

double orl_scale_value(const struct orl_scale *scale, const float rgb[3]);
double orl_scale_share(const struct orl_scale *scale, double value);

/* How many levels a value reaches. */
size_t orl_scale_band(const struct orl_scale *scale, double value);

/* Where contours at a level are in the palette, 0 to 1. */
double orl_scale_level_share(const struct orl_scale *scale, size_t level);

/* A number as it is written beside things: three digits. */
void orl_scale_text(double value, char ret_text[16]);

/* The ticks of a legend, and its palette. */
void orl_scale_legend(const struct orl_scale *scale, struct orl_legend *legend);

#endif
