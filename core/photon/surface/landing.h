/*
 * Assignment of photons to the facets on which they landed: by position and normal among the facets
 * of the photons before, or by a ray if that is ambiguous. For every leaf's first photon a ray is
 * traced, too: if it hits another facet than the one that holds the photon, the two coincide.
 *
 * Determinism: chunks of leaves are functions of the map and the scene. Threads: the work is done
 * by a crew.
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
    /* per photon: twice its facet, plus one for the front; or ORL_NOWHERE */
    uint32_t *places;
    atomic_bool *doubtful; /* per facet: another coincides with it */
};

/* Fills places, and marks doubtful facets; both arrays are the caller's. Returns 0 or an error
 * of orl_crew_try. */
int orl_landing_find(struct orl_landing *landing, struct orl_crew *crew);

/* The position of a photon, and its normal. */
struct orl_landed {
    struct orl_vec3 point, normal;
    uint16_t code; /* code of the normal */
};
struct orl_landed orl_landed_of(const struct orl_photon_map *map, uint64_t index);

#endif
