/*
 * Photons traced back to the facets they landed on: by place and normal among the facets of the
 * photons before, by a ray where that is not plain. Every leaf's first photon is asked by a ray as
 * well: where that meets another facet than the one that holds the photon, the two coincide.
 *
 * Determinism: chunks of leaves are functions of the map and the scene. Threads: a crew makes all.
 */
#ifndef ORL_PHOTON_SURFACE_LANDING_H
#define ORL_PHOTON_SURFACE_LANDING_H

#include <stdatomic.h>

#include <oriel/crew.h>

#include "photon/map/map.h"
#include "photon/surface/plane.h"

#define ORL_NOWHERE UINT32_MAX

struct orl_landing {
    const struct orl_photon_map *map;
    const struct orl_planes *planes;
    uint32_t *places;      /* per photon: twice its facet, and one for the front; or nowhere */
    atomic_bool *doubtful; /* per facet: another coincides with it */
};

/* Fills places, and marks what is doubtful; both arrays are the caller's. Returns 0 or what
 * orl_crew_try does. */
int orl_landing_find(struct orl_landing *landing, struct orl_crew *crew);

/* Where a photon lies. */
struct orl_landed {
    struct orl_vec3 point, normal;
    uint16_t code; /* of the normal */
};
struct orl_landed orl_landed_of(const struct orl_photon_map *map, uint64_t index);

#endif
