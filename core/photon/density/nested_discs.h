/*
 * Sums of the photons around a point in three nested discs, by whole leaves where possible: sums
 * over leaves, the search of a disc, and the discs.
 *
 * Sums over leaves, or halves of leaves, hold the centre of their photons, and their flux in
 * all and by batch. They serve estimates that are wide enough to treat sixteen photons as one. In
 * Morton order some runs of sixteen lie in two places far apart, or on two planes: such a leaf is
 * two patches, any other is one.
 *
 * Units: cells, and fluxes in the map's unit (header.flux_unit). Immutable once made; borrows the
 * map.
 */
#ifndef ORL_PHOTON_DENSITY_NESTED_DISCS_H
#define ORL_PHOTON_DENSITY_NESTED_DISCS_H

#include <oriel/base/thread_pool.h>

#include "photon/density/density_estimate.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

/* Layout of the sums of photons' fluxes, in one row for vectorised loops. */
enum {
    ORL_FLUX_SUMS_RGB =
        ORL_MAP_BATCHES, /* red, green, blue; the entries before are luma by batch */
    ORL_FLUX_SUMS_SQUARES = ORL_FLUX_SUMS_RGB + 3, /* squares of the photons' luma */
    ORL_FLUX_SUMS_COUNT,                           /* number of photons */
    ORL_FLUX_SUMS = 24                             /* the rest is 0 */
};

enum { ORL_NO_PLANE = 1 << 16 }; /* not a code of a normal (quantization.h) */
enum { ORL_PATCHES = 2, ORL_LANES = ORL_PATCHES * ORL_MAP_FANOUT };

/*
 * Eight sibling leaves of the map's hierarchy, in columns: their first patches, then their second
 * ones. Absent patches are farther away than any other.
 */
struct orl_patch_group {
    float at[3][ORL_LANES];
    float reach[ORL_LANES]; /* distance of the farthest photon from the centre */
    /* half width of a uniform distribution with the photons' standard deviation along an axis */
    float ramp[ORL_LANES];
    uint32_t normal[ORL_LANES]; /* or ORL_NO_PLANE: cannot be used as a whole */
    uint32_t count[ORL_LANES];  /* number of photons: the leaf's first, or its last */
};

struct orl_leaf_sums {
    const struct orl_photon_map *map;
    struct orl_patch_group *groups;
    float (*patch_sums)[ORL_FLUX_SUMS]; /* by patch */
    uint64_t count;                     /* number of leaves */
};

/* Returns the group and lane of a patch. Its number is twice the leaf's, plus one for the second
 * patch. */
static inline const struct orl_patch_group *orl_patch_find(const struct orl_leaf_sums *sums,
                                                           uint64_t patch, uint32_t *ret_lane)
{
    *ret_lane =
        (uint32_t)(patch % ORL_PATCHES * ORL_MAP_FANOUT + patch / ORL_PATCHES % ORL_MAP_FANOUT);
    return &sums->groups[patch / ORL_LANES];
}

static inline uint32_t orl_patch_number(uint32_t group, uint32_t lane)
{
    return group * ORL_LANES + lane % ORL_MAP_FANOUT * ORL_PATCHES + lane / ORL_MAP_FANOUT;
}

/* Computes the sums. Returns 0, ORL_ERR_NOMEM or an error of orl_parallel_try. */
int orl_leaf_sums_init(struct orl_leaf_sums *sums, const struct orl_photon_map *map,
                       struct orl_thread_pool *pool);
uint64_t orl_leaf_sums_bytes(const struct orl_leaf_sums *sums); /* memory, bytes */
void orl_leaf_sums_done(struct orl_leaf_sums *sums); /* a struct that is all zero is allowed */

/*
 * Search for the photons around a point, by whole leaves where possible: the first step of
 * orl_nested_discs_gather, below.
 */

enum { ORL_DISC_SEARCH_CAPACITY = 2 * ORL_SEARCH_MOST };

struct orl_disc_search {
    const struct orl_leaf_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint;   /* NULL: the whole disc */
    struct orl_whole_patches *whole_patches; /* patches found */
    struct orl_search_candidate *single;     /* single photons found */
    double cell;
    float at[3];           /* query point, in cells */
    float direction[3];    /* the query's normal */
    float radius2, radius; /* cells */
    float flat2; /* squared cells: photons nearer than this lie in the surface point's plane */
    /* In cells: photons within this radius and within these lines (orl_footprint_bound) are in the
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

/*
 * Sums of the photons around a point, in three discs that each have half the area of the next. The
 * photons are the nearest of the footprint, about query->k of them, or all within max_radius.
 *
 * Uses many more photons than orl_density_estimate, so most are read as whole patches: photons of a
 * leaf on the point's plane count together. The share of a patch within a disc is computed as if
 * its photons were spread evenly along the radius. In even light that share is right on average. It
 * scatters far less than sixteen photons that enter and leave at once. Leaves that are wide
 * relative to the discs, not flat, or cut by the footprint's border are split into photons.
 *
 * The radius is the one that holds k photons; it is found by counting, in steps of 1/512 of the
 * area searched.
 */

enum { ORL_NESTED_DISCS = 3 };

/* Sums over photons, also weighted by x and y as in struct orl_moments, in metres. */
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
