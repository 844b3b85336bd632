/*
 * A film's luminances, or illuminances if it holds irradiances, in false colours with a legend; and
 * their contours over the tone-mapped picture. The results match Radiance's falsecolor on the same
 * film: -s -l -n -log -m -e -pal, -cl and -cb.
 */
#ifndef ORL_RENDER_PICTURE_FALSE_COLOR_H
#define ORL_RENDER_PICTURE_FALSE_COLOR_H

#include "render/picture/display.h"
#include "render/picture/scale.h"

/* Writes one of ORL_PICTURE_FALSE, _LINES and _BANDS as PNG. shown is required for the latter two.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_false_color_write(const struct orl_film *film, const struct orl_tonemapped *tonemapped,
                          const struct orl_scale *scale, const struct orl_false_color *how,
                          enum orl_picture picture, const char *path, struct orl_error *err);

/* Returns the value of the pixel at a point of the picture, in the scale's unit. */
double orl_false_color_at(const struct orl_film *film, const struct orl_scale *scale, double x,
                          double y);

#endif
