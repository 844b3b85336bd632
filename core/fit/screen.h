/*
 * What light is caught on: the cells of a tensor tree's square, each with places in it that stand
 * for equal projected solid angles.
 *
 * A ray is spread over the places about it by (1 - d^2 / 12 sigma^2)^4, which is nearly a Gaussian,
 * has its width, and ends; what would fall below the horizon is folded up, so that even light stays
 * even to the edge. Its weights are scaled so that the light caught is the ray's, exactly.
 *
 * A screen is immutable once made; each thread has a brush of its own. Ownership: the caller's.
 */
#ifndef ORL_FIT_SCREEN_H
#define ORL_FIT_SCREEN_H

#include "bsdf/basis.h"
#include "fit/blend.h"

struct orl_fit_ball {
    float x, y, z, radius;
};

struct orl_fit_screen {
    unsigned levels; /* cells a side are 2^levels; numbered in Morton's order */
    size_t n_cells, n_tiles;
    double area;                         /* of a cell, projected, sr */
    float *x, *y, *z;                    /* places, sixteen to a cell; owned, as all below */
    struct orl_fit_ball *tiles, *groups; /* around four cells each, and 16 tiles */
    double spacing;                      /* of places, projected */
};

enum { ORL_FIT_TILE_CELLS = 4, ORL_FIT_CELL_POINTS = 16 };

/* levels: at least 1. 0 or ORL_ERR_NOMEM. */
int orl_fit_screen_make(unsigned levels, struct orl_fit_screen *ret_screen, struct orl_error *err);
void orl_fit_screen_done(struct orl_fit_screen *screen);

struct orl_fit_brush {
    float (*caught)[ORL_FIT_TILE_CELLS]; /* by tiles that a ray reaches, in cells of it */
    uint32_t *tiles;                     /* which these are */
    double *value;                       /* by cell: the result, 1/sr */
};
bool orl_fit_brush_make(const struct orl_fit_screen *screen, struct orl_fit_brush *ret_brush);
void orl_fit_brush_done(struct orl_fit_brush *brush);

/* Sets the brush's values. blur_rad: added to all widths, as squares. */
void orl_fit_draw(const struct orl_fit_screen *screen, const struct orl_fit_light *light,
                  double blur_rad, struct orl_fit_brush *brush);

#endif
