/*
 * Looking for the photons about a point, whole leaves of them where that will do: the first half of
 * rings.h, which see.
 */
#ifndef ORL_PHOTON_HUNT_H
#define ORL_PHOTON_HUNT_H

#include "photon/search.h"
#include "photon/sums.h"
#include "photon/zorder.h"

enum { ORL_HUNT_ROOM = 2 * ORL_SEARCH_MOST };

/* Leaves fill the candidates from the front, single photons from the back. */
struct orl_hunt {
    const struct orl_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    struct orl_search_candidate *list;
    double cell;
    float at[3];           /* cells */
    float direction[3];    /* the query's normal */
    float radius2, radius; /* cells */
    float flat2;           /* nearer than this photons lie in the footing's plane */
    float inner;           /* cells: within this the footprint is whole */
    float widest;          /* cells: leaves with wider ramps are taken apart */
    uint32_t leaves, photons, facing;
    uint16_t normal;
    bool full;
};

/* The footprint, and `inner` with it, may be set later. Borrows all. */
struct orl_hunt orl_hunt_of(const struct orl_sums *sums, const struct orl_density_query *query,
                            struct orl_search *search);

/* What the leaf the point falls in, and those next to it, tell of the radius that holds k. */
float orl_hunt_first_radius2(const struct orl_hunt *hunt, const struct orl_zorder *order);

/*
 * Finds k within the radius allowed, or all. radius2: where to begin. What was found reaches not
 * much further than the radius returned, so that leaves are as narrow as they should be for it.
 */
float orl_hunt_enough(struct orl_hunt *hunt, float radius2, float most2);

/* Photons within the radius looked at last. */
uint32_t orl_hunt_count(const struct orl_hunt *hunt);

#endif
