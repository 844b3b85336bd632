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

#endif
