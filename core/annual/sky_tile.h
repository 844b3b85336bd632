/*
 * Perez skies of some hours side by side, in all bins: single precision, so that a year's skies are
 * worked out in a moment. Errors of the approximations used (Abramowitz and Stegun 1964, 4.4.46 for
 * the arc cosine) are below 1e-6 of the radiance.
 */
#ifndef ORL_ANNUAL_SKY_TILE_H
#define ORL_ANNUAL_SKY_TILE_H

#include "annual/bins.h"
#include "light/daylight.h"

enum { ORL_SKY_ROW_HEIGHTS = 8 };

/* What the blend of sky and ground (light/sky.c) has for the rows. */
struct orl_sky_rows {
    const struct orl_bins *bins; /* borrowed */
    double sines[ORL_BINS_ROWS][ORL_SKY_ROW_HEIGHTS];
    double weights[ORL_BINS_ROWS][ORL_SKY_ROW_HEIGHTS]; /* of the sky, 0..1 */
    float ground[ORL_BINS_ROWS];                        /* mean weight of the ground */
    double per_ground;                                  /* W/m2 on a level plane, of brightness 1 */
};

void orl_sky_rows_init(struct orl_sky_rows *rows, const struct orl_bins *bins);

/* The skies of n columns, at most ORL_HOURS_TILE; columns beyond them are black. fine has ORL_BINS
 * rows of a tile's columns, coarse ORL_BINS_COARSE: means by solid angle. */
void orl_sky_tile_paint(const struct orl_sky_rows *rows, const struct orl_daylight *const *skies,
                        const double *diffuse_w, uint32_t n, double reflectance, float *ret_fine,
                        float *ret_coarse);

#endif
