/*
 * Hemisphere as a square of equal solid angles: the map of Shirley and Chiu after stretching the
 * disk's radius by sqrt(2) sin(theta / 2). All cells have the same solid angle. They are numbered
 * in Morton order, so cells of a quadtree are ranges of numbers.
 */
#ifndef ORL_BSDF_FIT_SCAN_EQUAL_AREA_SQUARE_H
#define ORL_BSDF_FIT_SCAN_EQUAL_AREA_SQUARE_H

#include <stdint.h>

#include "bsdf/tree/shirley.h"

enum { ORL_FIT_SQUARE_LEVELS = 14 }; /* cells of 0.01 degrees */

/* Returns the side in radians of a cell at a level, as if it were square. */
static inline double orl_fit_cell_rad(unsigned level)
{
    return sqrt(2 * ORL_PI) / (double)(UINT32_C(1) << level);
}
static inline double orl_fit_cell_sr(unsigned level)
{
    return 2 * ORL_PI / (double)(UINT64_C(1) << 2 * level);
}

/* Returns the direction of a place on the square; x and y from 0 to 1. */
static inline struct orl_vec3 orl_fit_from_square(double x, double y)
{
    const struct orl_vec3 d = orl_square_to_hemisphere((struct orl_square){2 * x - 1, 2 * y - 1});
    const double r2 = d.x * d.x + d.y * d.y, stretch = sqrt(orl_larger(0, 2 - r2));
    return orl_v3(d.x * stretch, d.y * stretch, orl_larger(0, 1 - r2));
}

static inline uint32_t orl_fit_morton_spread(uint32_t v)
{
    v = (v | v << 8) & 0x00ff00ffU;
    v = (v | v << 4) & 0x0f0f0f0fU;
    v = (v | v << 2) & 0x33333333U;
    return (v | v << 1) & 0x55555555U;
}

static inline uint32_t orl_fit_square_index(double s)
{
    const double side = UINT32_C(1) << ORL_FIT_SQUARE_LEVELS, c = (0.5 + 0.5 * s) * side;
    return c > 0 ? (c < side ? (uint32_t)c : (uint32_t)side - 1) : 0;
}

/* Returns the cell's number at the finest level; numbers in a coarser cell begin with the same
 * bits. */
static inline uint32_t orl_fit_morton_code(struct orl_vec3 d)
{
    const double shrink = 1 / sqrt(1 + orl_larger(d.z, 0));
    const struct orl_square s = orl_disk_to_square(d.x * shrink, d.y * shrink);
    return orl_fit_morton_spread(orl_fit_square_index(s.x)) |
           orl_fit_morton_spread(orl_fit_square_index(s.y)) << 1;
}

#endif
