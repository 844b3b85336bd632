/*
 * What the photons about a point hold, in three discs that each have half the area of the next: the
 * nearest of the footprint, about query->k of them, or all within max_radius.
 *
 * Far more photons than a plain search (search.h) needs, and so few are looked at one by one: a
 * patch of a leaf's photons on the point's plane counts as a whole (leaf_sums.h), by what share of
 * it is within a disc, as if its photons were spread evenly along the radius. In even light that
 * share is right on average, and it scatters far less than sixteen photons that come and go at
 * once. Leaves that are wide for the discs, not flat, or cut by the footprint's border are taken
 * apart into photons.
 *
 * The radius is the one that holds k photons; it is found by counting, in steps of 1/512 of the
 * area searched.
 */
#ifndef ORL_PHOTON_DENSITY_NESTED_DISCS_H
#define ORL_PHOTON_DENSITY_NESTED_DISCS_H

#include "photon/density/leaf_sums.h"
#include "photon/density/search.h"
#include "photon/map/zorder.h"
#include "photon/surface/moments.h"

enum { ORL_NESTED_DISCS = 3 };

/* Sums of photons (leaf_sums.h), and of those times x and y (moments.h), in metres. */
struct orl_nested_disc {
    float mass[ORL_MASS], by_x[ORL_MASS], by_y[ORL_MASS];
};

struct orl_nested_discs {
    /* 0: between the whole radius and 1 / sqrt 2 of it; 1: from there to half; 2: all within. */
    struct orl_nested_disc rings[ORL_NESTED_DISCS];
    struct orl_moments discs[ORL_NESTED_DISCS]; /* of the whole radius and so on */
    double radius, clear;                       /* as in a density */
    double disc;                                /* that would hold as many were it not cut */
    double found;                               /* photons within the radius */
    bool cut; /* not the whole disc: by_x and by_y are filled in */
};

/* Where a footprint within twice the disc that holds k has `least`, it is not made larger. */
void orl_nested_discs_gather(const struct orl_leaf_sums *sums, const struct orl_zorder *order,
                             const struct orl_density_query *query, double least,
                             struct orl_search *search, struct orl_nested_discs *ret_rings);

#endif
