/*
 * Looking for the photons about a point, whole leaves of them where that will do: the first half of
 * rings.h, which see.
 */
#ifndef ORL_PHOTON_HUNT_H
#define ORL_PHOTON_HUNT_H

#include "photon/search.h"
#include "photon/sides.h"
#include "photon/sums.h"
#include "photon/zorder.h"

enum { ORL_HUNT_ROOM = 2 * ORL_SEARCH_MOST };

struct orl_hunt {
    const struct orl_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    struct orl_search_wholes *wholes;      /* patches (sums.h) */
    struct orl_search_candidate *single;   /* and photons */
    double cell;
    float at[3];           /* cells */
    float direction[3];    /* the query's normal */
    float radius2, radius; /* cells */
    float flat2;           /* nearer than this photons lie in the footing's plane */
    /* Cells: within this radius, and these lines (sides.h), photons are in the footprint. */
    float bound, lines[ORL_BOUND_LINES][3], offsets[ORL_BOUND_LINES];
    uint32_t n_lines;
    float widest; /* cells: leaves with wider ramps are taken apart */
    uint32_t patches, photons, facing;
    uint16_t normal;
    bool full;
};

/* Of whole discs. Borrows all. */
struct orl_hunt orl_hunt_of(const struct orl_sums *sums, const struct orl_density_query *query,
                            struct orl_search *search);

/* From now on it looks for photons of the footprint alone, which it borrows. */
void orl_hunt_keep_to(struct orl_hunt *hunt, const struct orl_footprint *footprint);

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
