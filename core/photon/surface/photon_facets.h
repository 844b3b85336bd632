/*
 * Assignment of photons to the facets on which they landed: by position and normal among the facets
 * of the photons before, or by a ray if that is ambiguous. For every leaf's first photon a ray is
 * traced, too: if it hits another facet than the one that holds the photon, the two coincide.
 *
 * Determinism: chunks of leaves are functions of the map and the scene. Threads: the work is done
 * by a crew.
 */
#ifndef ORL_PHOTON_SURFACE_PHOTON_FACETS_H
#define ORL_PHOTON_SURFACE_PHOTON_FACETS_H

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>

#include "photon/map/map.h"
#include "photon/surface/facet_plane.h"

#define ORL_NO_FACET_SIDE UINT32_MAX

struct orl_photon_facets {
    const struct orl_photon_map *map;
    const struct orl_planes *planes;
    /* per photon: twice its facet, plus one for the front; or ORL_NO_FACET_SIDE */
    uint32_t *places;
    atomic_bool *coincident; /* per facet: another coincides with it */
};

/* Fills places, and marks doubtful facets; both arrays are the caller's. Returns 0 or an error
 * of orl_parallel_try. */
int orl_photon_facets_find(struct orl_photon_facets *photon_facets, struct orl_thread_pool *pool);

/* The position of a photon, and its normal. */
struct orl_stored_photon {
    struct orl_vec3 point, normal;
    uint16_t code; /* code of the normal */
};
struct orl_stored_photon orl_stored_photon_get(const struct orl_photon_map *map, uint64_t index);

#endif
