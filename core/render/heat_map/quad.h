/* Cells of a heat map on the page. */
#ifndef ORL_RENDER_HEAT_MAP_QUAD_H
#define ORL_RENDER_HEAT_MAP_QUAD_H

#include <oriel/base/canvas.h>

/* Four corners in order, of either orientation; convex. Page units. */
struct orl_quad {
    double x[4], y[4];
};
struct orl_quad orl_quad_of(double x0, double y0, double x1, double y1); /* a rectangle */

/* Hatches it with slanting lines; apart: their distance, page units. */
void orl_quad_hatch(struct orl_canvas *canvas, const struct orl_quad *quad, double apart,
                    const unsigned char rgb[3]);

#endif
