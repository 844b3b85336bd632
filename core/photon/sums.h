/*
 * Leaves of a map taken as wholes: where their photons' middle is, and what they hold together, in
 * all and by batch. For estimates wide enough that sixteen photons may stand as one.
 *
 * Units: cells, and fluxes in the map's unit (header.flux_unit). Immutable once made; borrows the
 * map.
 */
#ifndef ORL_PHOTON_SUMS_H
#define ORL_PHOTON_SUMS_H

#include <oriel/crew.h>

#include "photon/pack.h"

/* Sums of photons' fluxes, in one row that vectors are made of. */
enum {
    ORL_MASS_FLUX = ORL_MAP_BATCHES,      /* after luma by batch: red, green, blue */
    ORL_MASS_SQUARES = ORL_MASS_FLUX + 3, /* of the photons' luma */
    ORL_MASS_COUNT,                       /* photons */
    ORL_MASS = 24                         /* the rest is 0 */
};

enum { ORL_NO_PLANE = 1 << 16 }; /* no code of a normal (facing.h) */

/* Eight leaves in columns, which lie together in a map's hierarchy. */
struct orl_leaf_group {
    float at[3][ORL_MAP_FANOUT];
    float reach[ORL_MAP_FANOUT]; /* of the farthest photon from there */
    float ramp[ORL_MAP_FANOUT];  /* spread as evenly to either side, photons have the same standard
                                    deviation */
    uint32_t normal[ORL_MAP_FANOUT]; /* or ORL_NO_PLANE: not to be taken as a whole */
};

struct orl_sums {
    const struct orl_photon_map *map;
    struct orl_leaf_group *groups;
    float (*masses)[ORL_MASS]; /* by leaf */
    uint64_t count;            /* leaves */
};

/* Returns 0 or ORL_ERR_NOMEM. */
int orl_sums_init(struct orl_sums *sums, const struct orl_photon_map *map, struct orl_crew *crew);
uint64_t orl_sums_bytes(const struct orl_sums *sums); /* of memory */
void orl_sums_done(struct orl_sums *sums);            /* also of ones that are all zero */

#endif
