/*
 * Equal-area map between the square and the unit disk, as used by tensor trees: Shirley and Chiu,
 * "A low distortion map between disk and square", Journal of Graphics Tools 2(3), 1997. The disk is
 * the hemisphere projected along its axis, so equal areas of the square are equal projected solid
 * angles. The whole square is pi steradians.
 *
 * Square coordinates run from -1 to 1, with the pole at 0. Turning a direction by half a turn about
 * the axis negates both exactly. Both functions accept any input.
 */
#ifndef ORL_BSDF_TREE_SHIRLEY_H
#define ORL_BSDF_TREE_SHIRLEY_H

#include <stdint.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"

struct orl_square {
    double x, y;
};

struct orl_square orl_disk_to_square(double x, double y);

/* Returns the unit vector with z >= 0 above the disk point. z is computed without cancellation. */
static inline struct orl_vec3 orl_square_to_hemisphere(struct orl_square s)
{
    const int sideways = fabs(s.x) >= fabs(s.y);
    const double r = sideways ? s.x : s.y, other = sideways ? s.y : s.x;
    const double angle = r != 0 ? (ORL_PI / 4) * (other / r) : 0;
    const struct orl_sincos circle = orl_sincos_small(angle);
    const double along = r * circle.cosine, across = r * circle.sine;
    const double z2 = (1 - r) * (1 + r), z = sqrt(z2 > 0 ? z2 : 0);
    return sideways ? orl_v3(along, across, z) : orl_v3(across, along, z);
}

/* Returns the cell of a square coordinate, of `side` cells; 0 for NaN. */
static inline uint32_t orl_square_index(double s, uint32_t side)
{
    const double c = (0.5 + 0.5 * s) * side;
    return c > 0 ? (c < side ? (uint32_t)c : side - 1) : 0;
}

/*
 * Morton order: cells of a square are numbered by the interleaved bits of x and y, each bit of x
 * below that of y, so that the cells of a quadtree are ranges of numbers.
 */

/* Returns the low 16 bits of v in the even places. */
static inline uint32_t orl_morton_spread(uint32_t v)
{
    v = (v | v << 8) & 0x00ff00ffU;
    v = (v | v << 4) & 0x0f0f0f0fU;
    v = (v | v << 2) & 0x33333333U;
    return (v | v << 1) & 0x55555555U;
}

/* Returns the even bits of v, packed: x of a cell's number; y is that of v >> 1. */
static inline uint32_t orl_morton_even(uint32_t v)
{
    v &= 0x55555555U;
    v = (v | v >> 1) & 0x33333333U;
    v = (v | v >> 2) & 0x0f0f0f0fU;
    v = (v | v >> 4) & 0x00ff00ffU;
    return (v | v >> 8) & 0x0000ffffU;
}

/* Returns the direction of a place in a cell of a square of 2^levels cells a side; u and v from 0
 * to 1. */
static inline struct orl_vec3 orl_morton_direction(uint32_t cell, unsigned levels, double u,
                                                   double v)
{
    const double side = UINT32_C(1) << levels;
    return orl_square_to_hemisphere(
        (struct orl_square){2 * (orl_morton_even(cell) + u) / side - 1,
                            2 * (orl_morton_even(cell >> 1) + v) / side - 1});
}

#endif
