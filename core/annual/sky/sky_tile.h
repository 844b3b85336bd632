/*
 * Perez skies of several hours side by side, in all bins, in single precision for speed. Errors of
 * the approximations used (Abramowitz and Stegun 1964, 4.4.46 for the arc cosine) are below 1e-6 of
 * the radiance.
 */
#ifndef ORL_ANNUAL_SKY_SKY_TILE_H
#define ORL_ANNUAL_SKY_SKY_TILE_H

#include "annual/sky/bins.h"
#include "light/daylight.h"

enum { ORL_SKY_ROW_HEIGHTS = 8 };

/* Blend of sky and ground (light/sky.c), precomputed by row. */
struct orl_horizon_blend {
    const struct orl_bins *bins; /* borrowed */
    double sines[ORL_BINS_ROWS][ORL_SKY_ROW_HEIGHTS];
    double weights[ORL_BINS_ROWS][ORL_SKY_ROW_HEIGHTS]; /* share of the sky, 0..1 */
    float ground[ORL_BINS_ROWS];                        /* mean weight of the ground */
    double per_ground; /* W/m2 on a horizontal plane, per ground radiance of 1 */
};

void orl_horizon_blend_init(struct orl_horizon_blend *rows, const struct orl_bins *bins);

/*
 * Computes the skies of n columns, at most ORL_HOURS_TILE; columns from n on are black. ret_fine
 * has ORL_BINS rows of a tile's columns. ret_coarse has ORL_BINS_COARSE rows: means by solid angle.
 */
void orl_sky_tile_compute(const struct orl_horizon_blend *rows,
                          const struct orl_daylight *const *skies, const double *diffuse_w,
                          uint32_t n, double reflectance, float *ret_fine, float *ret_coarse);

#endif
