/*
 * Sums of the photons around a point, in three discs that each have half the area of the next. The
 * photons are the nearest of the footprint, about query->k of them, or all within max_radius.
 *
 * Uses many more photons than density_search.h, so most are read as whole patches: photons of a
 * leaf on the point's plane count together (leaf_sums.h). The share of a patch within a disc is
 * computed as if its photons were spread evenly along the radius. In even light that share is right
 * on average. It scatters far less than sixteen photons that enter and leave at once. Leaves that
 * are wide relative to the discs, not flat, or cut by the footprint's border are split into
 * photons.
 *
 * The radius is the one that holds k photons; it is found by counting, in steps of 1/512 of the
 * area searched.
 */
#ifndef ORL_PHOTON_DENSITY_NESTED_DISCS_H
#define ORL_PHOTON_DENSITY_NESTED_DISCS_H

#include "photon/density/density_search.h"
#include "photon/density/leaf_sums.h"
#include "photon/map/zorder.h"
#include "photon/surface/moments.h"

enum { ORL_NESTED_DISCS = 3 };

/* Sums over photons (leaf_sums.h), also weighted by x and y (moments.h), in metres. */
struct orl_nested_disc {
    float flux_sums[ORL_FLUX_SUMS], by_x[ORL_FLUX_SUMS], by_y[ORL_FLUX_SUMS];
};

struct orl_nested_discs {
    /* 0: between the whole radius and 1 / sqrt 2 of it; 1: from there to half; 2: all within. */
    struct orl_nested_disc rings[ORL_NESTED_DISCS];
    /* [0] has the whole radius, [1] 1 / sqrt 2 of it, [2] half */
    struct orl_moments discs[ORL_NESTED_DISCS];
    double radius, clearance; /* as in struct orl_density */
    double disc;              /* radius of an uncut disc of the same area */
    double found;             /* number of photons within the radius */
    bool cut; /* the disc is cut by the footprint, and by_x and by_y are filled in */
};

/* Finds the photons. A footprint within twice the disc that holds k is not enlarged if it holds
 * at least `least` photons. */
void orl_nested_discs_gather(const struct orl_leaf_sums *sums, const struct orl_zorder *order,
                             const struct orl_density_query *query, double least,
                             struct orl_search *search, struct orl_nested_discs *ret_rings);

#endif
