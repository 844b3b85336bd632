/*
 * Footprints as wholes: on which side of their border small spots lie, how far they are whole
 * discs, and where they are as large as one.
 */
#ifndef ORL_PHOTON_SURFACE_SIDES_H
#define ORL_PHOTON_SURFACE_SIDES_H

#include "photon/surface/footprint.h"

enum orl_side { ORL_SIDE_WITHIN, ORL_SIDE_BEYOND, ORL_SIDE_BOTH };

/* Photons of one plane: all no further than reach from a middle, and in a box; from the point. */
struct orl_spot {
    struct orl_vec3 middle, low, high;
    double reach, rounding; /* of the photons' places */
};

/* Where all of a spot of the footprint's plane lies. BOTH also where that is not known. */
enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_spot *spot);

/*
 * Straight lines, and a radius: what is within all of them lies in the footprint. Lines are by
 * their normals in space, from the point.
 */
enum { ORL_BOUND_LINES = 4 };
struct orl_bound {
    double radius;
    uint32_t n_lines;
    struct orl_vec3 normals[ORL_BOUND_LINES];
    double offsets[ORL_BOUND_LINES];
};

/* By the footprint's own lines, or by a radius alone where these are too many. */
struct orl_bound orl_footprint_bound(const struct orl_footprint *footprint);

/* About the radius within which the area is that of a whole disc of the radius given. */
double orl_footprint_even(const struct orl_footprint *footprint, double disc);

#endif
