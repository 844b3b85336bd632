/*
 * Density estimation: irradiance from the photons nearest to a point of a surface.
 *
 * A photon counts when it landed on the same sheet of surface (sheet.h), so that nothing is
 * gathered through a wall or from a parallel surface. The estimate over k neighbours is (sum of the
 * nearest k-1 fluxes) / (pi r_k^2), which is unbiased for uniform density; with fewer than k within
 * the largest radius, all of them over the largest disc.
 *
 * Reference: Jensen 2001, chapter 7.
 */
#ifndef ORL_PHOTON_SEARCH_H
#define ORL_PHOTON_SEARCH_H

#include <oriel/health.h>

#include "photon/map.h"

enum { ORL_SEARCH_MOST = 4096 };

struct orl_search_candidate {
    float distance2;
    uint32_t index;
};

/* Scratch, one per thread; big enough for k = ORL_SEARCH_MOST. */
struct orl_search {
    struct orl_search_candidate candidates[2 * ORL_SEARCH_MOST];
    struct orl_health health; /* what the thread counted; sparse is not in it yet */
};

struct orl_density_query {
    struct orl_vec3 point;  /* moved coordinates */
    struct orl_vec3 normal; /* unit, the lit side */
    uint32_t k;             /* 1 .. ORL_SEARCH_MOST */
    double max_radius;
    bool at_photon; /* the point is photon `skip`'s own, which is then left out: it would */
    uint32_t skip;  /* otherwise be counted wherever one asks about a photon's place */
};

struct orl_density {
    struct orl_rgb irradiance; /* W/m2 */
    double radius;             /* of the disc used */
    uint32_t found;            /* photons in it */
};

struct orl_density orl_density_estimate(const struct orl_photon_map *map,
                                        const struct orl_density_query *query,
                                        struct orl_search *search);

#endif
