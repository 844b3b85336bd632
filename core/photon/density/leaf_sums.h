/*
 * Sums over leaves of a map, or halves of leaves: the centre of their photons, and their flux in
 * all and by batch. They serve estimates that are wide enough to treat sixteen photons as one. In
 * Morton order some runs of sixteen lie in two places far apart, or on two planes: such a leaf is
 * two patches, any other is one.
 *
 * Units: cells, and fluxes in the map's unit (header.flux_unit). Immutable once made; borrows the
 * map.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_SUMS_H
#define ORL_PHOTON_DENSITY_LEAF_SUMS_H

#include <oriel/base/thread_pool.h>

#include "photon/map/map_layout.h"

/* Layout of the sums of photons' fluxes, in one row for vectorised loops. */
enum {
    ORL_FLUX_SUMS_RGB =
        ORL_MAP_BATCHES, /* red, green, blue; the entries before are luma by batch */
    ORL_FLUX_SUMS_SQUARES = ORL_FLUX_SUMS_RGB + 3, /* squares of the photons' luma */
    ORL_FLUX_SUMS_COUNT,                           /* number of photons */
    ORL_FLUX_SUMS = 24                             /* the rest is 0 */
};

enum { ORL_NO_PLANE = 1 << 16 }; /* not a code of a normal (normal_code.h) */
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

#endif
