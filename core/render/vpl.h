/*
 * Virtual point lights (Keller 1997): where photons landed on diffuse surfaces, as small lamps that
 * send on what the surface reflects. Together they are all the light that a place gets from diffuse
 * surfaces, without any density estimate; what they lack in smoothness shows as noise, not bias.
 *
 * A lamp very near to a place would shine without bound. The geometric factor of a connection is
 * therefore capped, and what the cap cuts off is left to rays that hit the near surface by
 * themselves (Kollig and Keller 2004): they take the share orl_vpl_left of it.
 *
 * Lamps are in as many independent groups as photons have batches, for standard errors.
 */
#ifndef ORL_RENDER_VPL_H
#define ORL_RENDER_VPL_H

#include "light/exterior.h"
#include "photon/shoot.h"

struct orl_vpl {
    float point[3], normal[3]; /* point: clear of the surface */
    float intensity[3]; /* W/sr along the normal, before the division by the number emitted */
};

struct orl_vpls {
    const struct orl_world *world; /* borrowed */
    struct orl_vpl *lamps;         /* group by group */
    size_t first[ORL_MAP_BATCHES + 1];
    double emitted;    /* paths per group */
    double most_sr_m2; /* the cap of cos cos / distance^2 */
};

/* From photons in order of emission, which are left alone. Returns 0 or ORL_ERR_NOMEM. */
int orl_vpls_init(struct orl_vpls *vpls, const struct orl_world *world,
                  const struct orl_photon *photons, size_t count, uint64_t emitted);
void orl_vpls_done(struct orl_vpls *vpls);

/* Irradiance at a place by one lamp, as if it stood for its whole group. */
struct orl_rgb orl_vpl_light(const struct orl_vpls *vpls, uint32_t group, size_t lamp,
                             struct orl_vec3 point, struct orl_vec3 normal);

/* The share of a surface's light that a ray of that length between those cosines is to take. */
static inline double orl_vpl_left(const struct orl_vpls *vpls, double cos_here, double cos_there,
                                  double distance)
{
    const double factor = fabs(cos_here * cos_there) / (distance * distance);
    return factor > vpls->most_sr_m2 ? 1 - vpls->most_sr_m2 / factor : 0;
}

#endif
