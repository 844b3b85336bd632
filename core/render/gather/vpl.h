/*
 * Virtual point lights (Keller 1997): where photons landed on diffuse surfaces, as small lamps that
 * send on what the surface reflects. Together they are all the light that a place gets from diffuse
 * surfaces, without any density estimate; what they lack in smoothness shows as noise, not bias.
 *
 * A lamp very near to a place would shine without bound. The geometric factor of a connection is
 * therefore capped, and what the cap cuts off is left to rays that hit the near surface by
 * themselves (Kollig and Keller 2004): they take the share orl_vpl_left of it.
 *
 * Lamps are in as many independent groups as photons have batches, for standard errors. Those of a
 * group are leaves of a binary tree; a place draws one by going down from the root, at each fork by
 * lot, by how much each side may light the place (Yuksel 2019, stochastic lightcuts).
 */
#ifndef ORL_RENDER_GATHER_VPL_H
#define ORL_RENDER_GATHER_VPL_H

#include <oriel/crew.h>

#include "light/direct.h"
#include "photon/shooting/shoot.h"

struct orl_vpl {
    float place[6];     /* point, clear of the surface, and normal */
    float intensity[3]; /* W/sr along the normal, before the division by the number emitted */
};

/* Neighbours, within a box; normals within a spread of the normal. */
struct orl_vpl_node {
    float center[3], half[3], normal[3];
    float radius, spread;
    float power;           /* sum of the lamps' intensities: luma */
    uint32_t first, count; /* lamps */
    uint32_t right;        /* node; the left one is the next. 0: a leaf */
};

struct orl_vpls {
    const struct orl_world *world; /* borrowed */
    struct orl_vpl *lamps;         /* group by group */
    size_t first[ORL_MAP_BATCHES + 1];
    struct orl_vpl_node *nodes;      /* of all trees */
    uint32_t roots[ORL_MAP_BATCHES]; /* of groups that have lamps */
    double emitted;                  /* paths per group */
    double most_sr_m2;               /* the cap of cos cos / distance^2 */
};

/* From photons in order of emission, which are left alone. Returns 0, ORL_ERR_NOMEM or what
 * orl_crew_try does. */
int orl_vpls_init(struct orl_vpls *vpls, const struct orl_world *world, struct orl_crew *crew,
                  const struct orl_photon *photons, size_t count, uint64_t emitted);
void orl_vpls_done(struct orl_vpls *vpls);

/*
 * One estimate of the irradiance at a place by all of a group's lamps, from that many of them.
 * u: even over samples.
 */
struct orl_rgb orl_vpl_light(const struct orl_vpls *vpls, uint32_t group, double u, uint32_t lamps,
                             struct orl_vec3 point, struct orl_vec3 normal);

/* The top of a group's tree as a place sees it: forks of which most depends are decided first. */
enum { ORL_VPL_MOST_CUT = 32 };
struct orl_vpl_cut {
    uint32_t nodes[ORL_VPL_MOST_CUT];
    double light[ORL_VPL_MOST_CUT];  /* about */
    double unsure[ORL_VPL_MOST_CUT]; /* of it, 0 where there is nothing to decide */
    uint32_t count;
    double sum; /* of light; 0: no lamp lights the place */
};
void orl_vpl_cut_init(struct orl_vpl_cut *cut, const struct orl_vpls *vpls, uint32_t group,
                      uint32_t size, struct orl_vec3 point, struct orl_vec3 normal);

/* A lamp drawn by a cut of the same place, and the probability; false when none lights it. */
bool orl_vpl_draw(const struct orl_vpls *vpls, const struct orl_vpl_cut *cut, double u,
                  struct orl_vec3 point, struct orl_vec3 normal, uint32_t *ret_lamp,
                  double *ret_probability);

/* Makes the trees, and puts the lamps in their order. Returns as orl_vpls_init. */
int orl_vpl_plant(struct orl_vpls *vpls, struct orl_crew *crew);

/* The share of a surface's light that a ray of that length between those cosines is to take. */
static inline double orl_vpl_left(const struct orl_vpls *vpls, double cos_here, double cos_there,
                                  double distance)
{
    const double factor = fabs(cos_here * cos_there) / (distance * distance);
    return factor > vpls->most_sr_m2 ? 1 - vpls->most_sr_m2 / factor : 0;
}

#endif
