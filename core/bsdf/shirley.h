/*
 * The equal-area map between the square and the unit disk of Shirley and Chiu ("A low distortion
 * map between disk and square", Journal of Graphics Tools 2(3), 1997), as tensor trees use it: the
 * disk is the hemisphere seen along its axis, so that equal areas of the square are equal
 * projected solid angles, pi steradians for the whole square.
 *
 * Square coordinates here run from -1 to 1, with the pole at 0: turning a direction by half a turn
 * about the axis negates both, exactly. Both functions are total.
 */
#ifndef ORL_BSDF_SHIRLEY_H
#define ORL_BSDF_SHIRLEY_H

#include <oriel/vec.h>

struct orl_square {
    double x, y;
};

struct orl_square orl_disk_to_square(double x, double y);

/* The unit vector with z >= 0 above the disk point. z is computed without cancellation. */
struct orl_vec3 orl_square_to_hemisphere(struct orl_square s);

#endif
