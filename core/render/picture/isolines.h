/*
 * Lines of equal value over a picture, with what they stand for written beside them.
 *
 * By marching squares between the pixels' middles (Lorensen and Cline 1987, in two dimensions), of
 * values smoothed by a little so that noise draws no lines. Where values leap over more than a step
 * of the levels from pixel to pixel there is the edge of a thing, and no line.
 */
#ifndef ORL_RENDER_PICTURE_ISOLINES_H
#define ORL_RENDER_PICTURE_ISOLINES_H

#include "base/letters.h"
#include "render/picture/scale.h"

/* How the lines of a level are drawn, and their texts. */
typedef struct orl_pen (*orl_isoline_pen)(const struct orl_scale *scale, size_t level, double unit);

/* Over the upper left of a raster, where the film's picture is. Texts keep off the named
 * points. unit: pixels of a legend's unit.
 * Returns 0 or ORL_ERR_NOMEM. */
int orl_isolines_draw(const struct orl_raster *raster, const struct orl_film *film,
                      const struct orl_scale *scale, const struct orl_false_color *how,
                      orl_isoline_pen pen, double unit);

/* A text that is legible on anything, with its middle at (x, y): in the pen's colour, on a rim of
 * the other extreme. */
void orl_letters_on_anything(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                             double y, const char *text);

#endif
