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

struct orl_leaf_sum {
    float at[3];
    float reach;   /* of the farthest photon from there; INFINITY: on no one plane, not to be taken
                      as a whole */
    float ramp;    /* spread as evenly to either side, photons have the same standard deviation */
    float flux[3]; /* red, green, blue */
    float squares; /* of the photons' luma */
    uint16_t normal, count;
    float luma[ORL_MAP_BATCHES];
};

struct orl_sums {
    const struct orl_photon_map *map;
    struct orl_leaf_sum *leaves;
    uint64_t count;
};

/* Returns 0 or ORL_ERR_NOMEM. */
int orl_sums_init(struct orl_sums *sums, const struct orl_photon_map *map, struct orl_crew *crew);
void orl_sums_done(struct orl_sums *sums); /* also of ones that are all zero */

#endif
