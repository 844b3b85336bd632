/*
 * A page that is drawn either into pixels or into the text of an SVG: the same calls, the same
 * picture. Pixels from the upper left, y down; SVG has them as its units.
 */
#ifndef ORL_RENDER_HEAT_MAP_CANVAS_H
#define ORL_RENDER_HEAT_MAP_CANVAS_H

#include <stdio.h>

#include "base/letters.h"

struct orl_canvas {
    struct orl_raster raster; /* its pixels are owned; NULL when it is an SVG */
    FILE *svg;                /* borrowed; NULL when it is pixels */
};

/* White, of that size; with a stream an SVG begins there. Returns 0 or ORL_ERR_NOMEM. */
int orl_canvas_init(struct orl_canvas *canvas, uint32_t width, uint32_t height, FILE *svg);
void orl_canvas_end(struct orl_canvas *canvas); /* of an SVG: writes its end */
void orl_canvas_done(struct orl_canvas *canvas);

/* Four corners in order, either way about; convex. */
struct orl_quad {
    double x[4], y[4];
};
struct orl_quad orl_quad_of(double x0, double y0, double x1, double y1); /* a rectangle's */

void orl_canvas_fill(struct orl_canvas *canvas, const struct orl_quad *quad,
                     const unsigned char rgb[3]);
void orl_canvas_line(struct orl_canvas *canvas, double x0, double y0, double x1, double y1,
                     double weight, const unsigned char rgb[3]);
/* Slanting lines over a quad, so many pixels apart. */
void orl_canvas_hatch(struct orl_canvas *canvas, const struct orl_quad *quad, double apart,
                      const unsigned char rgb[3]);

enum orl_canvas_align { ORL_CANVAS_LEFT, ORL_CANVAS_MIDDLE, ORL_CANVAS_RIGHT };
/* size: height of capitals. The text is ASCII and stands on y. */
void orl_canvas_text(struct orl_canvas *canvas, double x, double y, double size,
                     enum orl_canvas_align align, const unsigned char rgb[3], const char *text);

#endif
