/*
 * Looking for the photons about a point, whole leaves of them where that will do: the first half of
 * nested_discs.h, which see.
 */
#ifndef ORL_PHOTON_DENSITY_DISC_SEARCH_H
#define ORL_PHOTON_DENSITY_DISC_SEARCH_H

#include "photon/density/leaf_sums.h"
#include "photon/density/search.h"
#include "photon/map/zorder.h"
#include "photon/surface/sides.h"

enum { ORL_DISC_SEARCH_ROOM = 2 * ORL_SEARCH_MOST };

struct orl_disc_search {
    const struct orl_leaf_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    struct orl_search_wholes *wholes;      /* patches (leaf_sums.h) */
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
struct orl_disc_search orl_disc_search_of(const struct orl_leaf_sums *sums,
                                          const struct orl_density_query *query,
                                          struct orl_search *search);

/* From now on it looks for photons of the footprint alone, which it borrows. */
void orl_disc_search_keep_to(struct orl_disc_search *hunt, const struct orl_footprint *footprint);

/* What the leaf the point falls in, and those next to it, tell of the radius that holds k. */
float orl_disc_search_first_radius2(const struct orl_disc_search *hunt,
                                    const struct orl_zorder *order);

/*
 * Finds k within the radius allowed, or all. radius2: where to begin. What was found reaches not
 * much further than the radius returned, so that leaves are as narrow as they should be for it.
 */
float orl_disc_search_enough(struct orl_disc_search *hunt, float radius2, float most2);

/* Photons within the radius looked at last. */
uint32_t orl_disc_search_count(const struct orl_disc_search *hunt);

#endif
