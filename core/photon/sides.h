/*
 * Footprints as wholes: on which side of their border small patches lie, how far they are whole
 * discs, and where they are as large as one.
 */
#ifndef ORL_PHOTON_SIDES_H
#define ORL_PHOTON_SIDES_H

#include "photon/footprint.h"

enum orl_side { ORL_SIDE_WITHIN, ORL_SIDE_BEYOND, ORL_SIDE_BOTH };

/* Photons of one plane: all no further than reach from a middle, and in a box; from the point. */
struct orl_patch {
    struct orl_vec3 middle, low, high;
    double reach, rounding; /* of the photons' places */
};

/* Where all of a patch of the footprint's plane lies. BOTH also where that is not known. */
enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_patch *patch);

/* The radius within which no sector ends. */
double orl_footprint_inner(const struct orl_footprint *footprint);

/* About the radius within which the area is that of a whole disc of the radius given. */
double orl_footprint_even(const struct orl_footprint *footprint, double disc);

#endif
