/*
 * Raster of directions out: the cells of a tensor tree's square. Each cell has sample points of
 * equal projected solid angle.
 *
 * A ray is spread over the points around it by (1 - d^2 / 12 sigma^2)^4. This kernel is nearly a
 * Gaussian of the same width, but has a finite radius. Light below the horizon is reflected up, so
 * that uniform light stays uniform to the edge. Weights are scaled so that the sum is exactly the
 * ray's light.
 *
 * A raster is immutable once made; each thread has its own accumulator. Ownership: the caller's.
 */
#ifndef ORL_BSDF_FIT_RASTER_H
#define ORL_BSDF_FIT_RASTER_H

#include "bsdf/fit/transport/interpolate.h"
#include "bsdf/matrix/basis.h"

struct orl_fit_sphere {
    float x, y, z, radius;
};

struct orl_fit_raster {
    unsigned levels; /* there are 2^levels cells a side, numbered in Morton order */
    size_t n_cells, n_tiles;
    double area;      /* projected solid angle of a cell, sr */
    float *x, *y, *z; /* sample points, sixteen to a cell; owned, like all pointers below */
    struct orl_fit_sphere *tiles, *groups; /* bounding balls of four cells, of 16 tiles */
    double spacing;                        /* distance of sample points, projected */
};

enum { ORL_FIT_TILE_CELLS = 4, ORL_FIT_CELL_POINTS = 16 };

/* levels: at least 1. Returns 0 or ORL_ERR_NOMEM. */
int orl_fit_raster_make(unsigned levels, struct orl_fit_raster *ret_raster, struct orl_error *err);
void orl_fit_raster_done(struct orl_fit_raster *raster);

struct orl_fit_accumulator {
    float (*accumulated)[ORL_FIT_TILE_CELLS]; /* [tile reached][cell of it]: kernel sums of a ray */
    uint32_t *tiles;                          /* numbers of these tiles */
    double *value;                            /* by cell: the result, 1/sr */
};
bool orl_fit_accumulator_make(const struct orl_fit_raster *raster,
                              struct orl_fit_accumulator *ret_accumulator);
void orl_fit_accumulator_done(struct orl_fit_accumulator *accumulator);

/* Sets the accumulator's values to the light. blur_rad is added to all widths in quadrature. */
void orl_fit_rasterize(const struct orl_fit_raster *raster, const struct orl_fit_light *light,
                       double blur_rad, struct orl_fit_accumulator *accumulator);

#endif
