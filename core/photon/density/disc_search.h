/*
 * Search for the photons around a point, by whole leaves where possible: the first half of
 * nested_discs.h, which explains it.
 */
#ifndef ORL_PHOTON_DENSITY_DISC_SEARCH_H
#define ORL_PHOTON_DENSITY_DISC_SEARCH_H

#include "photon/density/density_search.h"
#include "photon/density/leaf_sums.h"
#include "photon/map/zorder.h"
#include "photon/surface/footprint_side.h"

enum { ORL_DISC_SEARCH_CAPACITY = 2 * ORL_SEARCH_MOST };

struct orl_disc_search {
    const struct orl_leaf_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint;   /* NULL: the whole disc */
    struct orl_whole_patches *whole_patches; /* patches found (leaf_sums.h) */
    struct orl_search_candidate *single;     /* single photons found */
    double cell;
    float at[3];           /* query point, in cells */
    float direction[3];    /* the query's normal */
    float radius2, radius; /* cells */
    float flat2; /* squared cells: photons nearer than this lie in the surface point's plane */
    /* In cells: photons within this radius and within these lines (footprint_side.h) are in the
     * footprint. */
    float bound, lines[ORL_BOUND_LINES][3], offsets[ORL_BOUND_LINES];
    uint32_t n_lines;
    float widest; /* cells: leaves with wider ramps are split into photons */
    uint32_t patches, photons, normal_bins;
    uint16_t normal;
    bool full;
};

/* Returns a search of whole discs. Borrows its arguments. */
struct orl_disc_search orl_disc_search_of(const struct orl_leaf_sums *sums,
                                          const struct orl_density_query *query,
                                          struct orl_search *search);

/* Restricts the search to photons of the footprint, which it borrows. */
void orl_disc_search_restrict(struct orl_disc_search *disc_search,
                              const struct orl_footprint *footprint);

/* Returns an initial squared radius for k photons, from the leaf around the point and those next
 * to it. */
float orl_disc_search_first_radius2(const struct orl_disc_search *disc_search,
                                    const struct orl_zorder *order);

/*
 * Finds k photons within the maximum radius, or all there are. radius2: initial squared radius. The
 * photons found extend little beyond the returned squared radius, so that leaves are narrow enough
 * for it.
 */
float orl_disc_search_find(struct orl_disc_search *disc_search, float radius2, float most2);

/* Returns the number of photons within the radius of the last search. */
uint32_t orl_disc_search_count(const struct orl_disc_search *disc_search);

#endif
