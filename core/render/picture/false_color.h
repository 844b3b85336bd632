/*
 * A film's luminances, or illuminances where it holds irradiances, in false colours, with a legend;
 * and their contours over the picture to look at. What Radiance's falsecolor makes of the same
 * film: -s -l -n -log -m -e -pal, -cl and -cb.
 */
#ifndef ORL_RENDER_PICTURE_FALSE_COLOR_H
#define ORL_RENDER_PICTURE_FALSE_COLOR_H

#include "render/picture/display.h"
#include "render/picture/scale.h"

/* One of ORL_PICTURE_FALSE, _LINES and _BANDS as PNG. shown is needed for the latter two. Returns
 * 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_false_color_write(const struct orl_film *film, const struct orl_shown *shown,
                          const struct orl_scale *scale, const struct orl_false_color *how,
                          enum orl_picture picture, const char *path, struct orl_error *err);

/* The value at a point of the picture, in the scale's unit: that of its pixel. */
double orl_false_color_at(const struct orl_film *film, const struct orl_scale *scale, double x,
                          double y);

#endif
