/*
 * Virtual point lights (Keller 1997): photons stored on diffuse surfaces become small lamps that
 * emit what the surface reflects. Together they are all the light from diffuse surfaces at a place,
 * without a density estimate; their error is noise, not bias.
 *
 * A lamp very near to a place would shine without bound. The geometric factor of a connection is
 * therefore capped. Rays that hit the near surface by themselves carry the remainder,
 * orl_vpl_clamped_share of it (Kollig and Keller 2004).
 *
 * Lamps are in as many independent groups as photons have batches, for standard errors. Those of a
 * group are leaves of a binary tree. A place draws a lamp by descending from the root, choosing a
 * side at random by an estimate of its light (Yuksel 2019, stochastic lightcuts).
 */
#ifndef ORL_RENDER_GATHER_VPL_H
#define ORL_RENDER_GATHER_VPL_H

#include <oriel/base/thread_pool.h>

#include "light/direct.h"
#include "photon/shooting/shoot.h"

struct orl_vpl {
    float place[6];     /* position, offset from the surface, and normal */
    float intensity[3]; /* W/sr along the normal, before the division by the number emitted */
};

/* A node of neighbouring lamps: bounding box, and normals within a spread of the mean normal. */
struct orl_vpl_node {
    float center[3], half[3], normal[3];
    float radius, spread;
    float power;           /* sum of the lamps' intensities, luma */
    uint32_t first, count; /* index of its first lamp, and their number */
    uint32_t right;        /* index of the right child; the left one is the next node; 0: a leaf */
};

struct orl_vpls {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_vpl *lamps;                 /* sorted by group */
    size_t first[ORL_MAP_BATCHES + 1];
    struct orl_vpl_node *nodes;      /* nodes of all trees */
    uint32_t roots[ORL_MAP_BATCHES]; /* only valid for groups that have lamps */
    double emitted;                  /* number of paths per group */
    double max_factor_sr_m2;         /* maximum of cos cos / distance^2 */
};

/* Makes lights from photons in order of emission, which stay unchanged. Returns 0, ORL_ERR_NOMEM or
 * the codes of orl_parallel_try. */
int orl_vpls_init(struct orl_vpls *vpls, const struct orl_lit_scene *lit_scene,
                  struct orl_thread_pool *pool, const struct orl_photon *photons, size_t count,
                  uint64_t emitted);
void orl_vpls_done(struct orl_vpls *vpls);

/* Returns one estimate of the irradiance at a place by all lamps of a group, from a sample of that
 * many. u: stratified over samples. */
struct orl_rgb orl_vpl_irradiance(const struct orl_vpls *vpls, uint32_t group, double u,
                                  uint32_t lamps, struct orl_vec3 point, struct orl_vec3 normal);

/* Returns the share of a surface's light that a ray of that length and those cosines must carry. */
static inline double orl_vpl_clamped_share(const struct orl_vpls *vpls, double cos_here,
                                           double cos_there, double distance)
{
    const double factor = fabs(cos_here * cos_there) / (distance * distance);
    return factor > vpls->max_factor_sr_m2 ? 1 - vpls->max_factor_sr_m2 / factor : 0;
}

#endif
