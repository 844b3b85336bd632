/*
 * Draws lines of equal value over a picture, labelled with their values.
 *
 * Lines are found by marching squares between the pixels' centres (Lorensen and Cline 1987, in two
 * dimensions). Values are smoothed slightly so that noise draws no lines. Where values jump by more
 * than a step of the levels between pixels there is the edge of an object, and no line is drawn.
 */
#ifndef ORL_RENDER_PICTURE_ISOLINES_H
#define ORL_RENDER_PICTURE_ISOLINES_H

#include "base/text/stroke_font.h"
#include "render/picture/scale.h"

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

#endif
