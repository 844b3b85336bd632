/*
 * Leaves of a map taken as wholes, or as halves: where their photons' middle is, and what they hold
 * together, in all and by batch. For estimates wide enough that sixteen photons may stand as one.
 * In Morton order some sixteen in a row lie in two places far apart, or on two planes: such a leaf
 * is two patches, any other is one.
 *
 * Units: cells, and fluxes in the map's unit (header.flux_unit). Immutable once made; borrows the
 * map.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_SUMS_H
#define ORL_PHOTON_DENSITY_LEAF_SUMS_H

#include <oriel/crew.h>

#include "photon/map/map_layout.h"

/* Sums of photons' fluxes, in one row that vectors are made of. */
enum {
    ORL_MASS_FLUX = ORL_MAP_BATCHES,      /* after luma by batch: red, green, blue */
    ORL_MASS_SQUARES = ORL_MASS_FLUX + 3, /* of the photons' luma */
    ORL_MASS_COUNT,                       /* photons */
    ORL_MASS = 24                         /* the rest is 0 */
};

enum { ORL_NO_PLANE = 1 << 16 }; /* no code of a normal (facing.h) */
enum { ORL_PATCHES = 2, ORL_LANES = ORL_PATCHES * ORL_MAP_FANOUT };

/*
 * Eight leaves in columns, which lie together in a map's hierarchy: their first patches, and then
 * their second ones. What is not there is farther away than anything.
 */
struct orl_patch_group {
    float at[3][ORL_LANES];
    float reach[ORL_LANES];     /* of the farthest photon from there */
    float ramp[ORL_LANES];      /* spread as evenly to either side, photons have the same standard
                                   deviation */
    uint32_t normal[ORL_LANES]; /* or ORL_NO_PLANE: not to be taken as a whole */
    uint32_t count[ORL_LANES];  /* photons: the leaf's first, or its last */
};

struct orl_leaf_sums {
    const struct orl_photon_map *map;
    struct orl_patch_group *groups;
    float (*masses)[ORL_MASS]; /* by patch */
    uint64_t count;            /* leaves */
};

/* A patch by its number: twice the leaf's, and one for the second. */
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

/* Returns 0, ORL_ERR_NOMEM or what orl_crew_try does. */
int orl_leaf_sums_init(struct orl_leaf_sums *sums, const struct orl_photon_map *map,
                       struct orl_crew *crew);
uint64_t orl_leaf_sums_bytes(const struct orl_leaf_sums *sums); /* of memory */
void orl_leaf_sums_done(struct orl_leaf_sums *sums);            /* also of ones that are all zero */

#endif
