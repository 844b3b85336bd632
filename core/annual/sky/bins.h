/* Bins of directions, and Perez skies of several hours in all bins. */
#ifndef ORL_ANNUAL_SKY_BINS_H
#define ORL_ANNUAL_SKY_BINS_H

#include <stdint.h>

#include <oriel/base/vec.h>

#include "light/daylight/daylight.h"

/*
 * Bins of directions. Above the horizon they are Reinhart's subdivision MF:4 of Tregenza's sky:
 * 2305 patches in 29 rows of equal height, the last one around the zenith. Below the horizon are
 * six rows of the same height, where sky and ground blend (light/daylight/sky.c), and one bin for
 * the rest. Each bin belongs to a coarse bin: a Tregenza patch of four columns and rows, or a row
 * below the horizon.
 *
 * Conventions: azimuth is clockwise from +Y (north) of the sky, and the first bin of a row is
 * centred on it. Rows are counted from the horizon. Bins above it are in the order of Radiance's
 * reinhart.cal. References: Tregenza 1987, Lighting Research and Technology 19(1), 13; Reinhart and
 * Walkenhorst 2001, Energy and Buildings 33(7), 683.
 */

enum {
    ORL_BINS_FINE = 4,
    ORL_BINS_ABOVE_ROWS = 7 * ORL_BINS_FINE + 1,
    ORL_BINS_BELOW_ROWS = 6,
    ORL_BINS_ROWS = ORL_BINS_ABOVE_ROWS + ORL_BINS_BELOW_ROWS + 1,
    ORL_BINS_BELOW_COLUMNS = 24,
    ORL_BINS_ABOVE = 144 * ORL_BINS_FINE * ORL_BINS_FINE + 1,
    ORL_BINS = ORL_BINS_ABOVE + ORL_BINS_BELOW_ROWS * ORL_BINS_BELOW_COLUMNS + 1,
    ORL_BINS_COARSE = 145 + ORL_BINS_BELOW_ROWS + 1
};

/* A row between two altitudes. Rows below the horizon are numbered downwards. */
struct orl_bin_row {
    double low, high; /* sines of altitude, low < high */
    uint32_t first, columns;
};

struct orl_bins {
    struct orl_bin_row rows[ORL_BINS_ROWS];
    struct orl_vec3 at[ORL_BINS]; /* unit vector to the middle of each bin */
    double solid_sr[ORL_BINS];
    /* Solid angle times sine of altitude: irradiance of a horizontal plane per radiance. */
    double level_sr[ORL_BINS];
    uint16_t row_of[ORL_BINS], coarse_of[ORL_BINS];
};

void orl_bins_init(struct orl_bins *bins);

/* Returns the bin that contains a unit direction. */
uint32_t orl_bins_find(const struct orl_bins *bins, struct orl_vec3 direction);

/*
 * Perez skies of several hours side by side, in all bins, in single precision for speed. Errors of
 * the approximations used (Abramowitz and Stegun 1964, 4.4.46 for the arc cosine) are below 1e-6 of
 * the radiance.
 */

enum { ORL_SKY_ROW_HEIGHTS = 8 };

/* Blend of sky and ground (light/daylight/sky.c), precomputed by row. */
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
