/*
 * Queries of footprints: the side of the border on which small spots lie, and radii at which a
 * footprint is a whole disc or has the area of one.
 */
#ifndef ORL_PHOTON_SURFACE_FOOTPRINT_SIDE_H
#define ORL_PHOTON_SURFACE_FOOTPRINT_SIDE_H

#include "photon/surface/footprint.h"

enum orl_side { ORL_SIDE_INSIDE, ORL_SIDE_OUTSIDE, ORL_SIDE_BOTH };

/* Photons of one plane, relative to the point: within `reach` of a middle, and in a box. */
struct orl_photon_cluster {
    struct orl_vec3 middle, low, high;
    double reach, rounding; /* rounding: that of the photons' positions */
};

/* Returns the side of the border on which all of a spot in the footprint's plane lies; BOTH if
 * that is uncertain. */
enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_photon_cluster *cluster);

/*
 * Straight lines and a radius: points within all of them lie in the footprint. Lines are given by
 * their normals in space, relative to the point.
 */
enum { ORL_BOUND_LINES = 4 };
struct orl_convex_bound {
    double radius;
    uint32_t n_lines;
    struct orl_vec3 normals[ORL_BOUND_LINES];
    double offsets[ORL_BOUND_LINES];
};

/* Returns the footprint's own lines, or a radius only if there are too many lines. */
struct orl_convex_bound orl_footprint_bound(const struct orl_footprint *footprint);

/* Returns the approximate radius within which the footprint has the area of a whole disc of
 * radius `disc`. */
double orl_footprint_equal_radius(const struct orl_footprint *footprint, double disc);

#endif
