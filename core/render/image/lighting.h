/*
 * Light at the diffuse surfaces that a view ray meets, from photon maps and records, in two parts.
 * The direct part may change abruptly, along shadow edges, and is computed for every ray. The
 * smooth part varies slowly along a surface, so that one place can give it for its neighbours.
 */
#ifndef ORL_RENDER_IMAGE_LIGHTING_H
#define ORL_RENDER_IMAGE_LIGHTING_H

#include "render/gather/icache.h"
#include "render/image/shade.h"

struct orl_lighting {
    const struct orl_gather *gather; /* borrowed, like the cache */
    const struct orl_icache *cache;
    struct orl_pixel_footprint footprint;
    uint32_t shadow_rays; /* per ray and light */
};

/* Most recent records for places that the cache does not reach, such as objects that no pixel's
 * centre shows. Each tile has its own; empty at first. */
enum { ORL_RECENT_RECORDS = 64 };
struct orl_recent_records {
    struct orl_irradiance_record records[ORL_RECENT_RECORDS];
    uint32_t made;
};

/* Returns true if the rest is gathered at a place. Other estimators read maps where photons are
 * stored. */
static inline bool orl_lighting_gathers(const struct orl_gather *gather,
                                        const struct orl_shading_point *place)
{
    return gather->indirect->gathered || place->outside;
}

/*
 * Returns the share of the rest, 0 to 1, that is gathered although records are read. It is positive
 * where the records differ: in dark places beside lit ones, which the records are too wide to
 * resolve.
 */
double orl_lighting_gathered_share(const struct orl_density *read);

/* Direct light by all surfaces that a ray saw, as radiance. */
struct orl_direct_lighting {
    struct orl_rgb radiance;
    double variance; /* variance of its luma by the shadow rays, if there are several */
};
struct orl_direct_lighting orl_lighting_direct(const struct orl_lighting *lighting,
                                               const struct orl_shaded_ray *shaded,
                                               uint32_t sequence, uint32_t first,
                                               struct orl_health *health);

/* Caustics and the rest, as radiance, and the standard errors of the luma of either. */
struct orl_smooth_lighting {
    struct orl_rgb radiance;
    double caustic; /* luma of the caustic part */
    double rest_error, caustic_error;
    double reach; /* distance from the first surface's point within which it is nearly constant */
};
struct orl_smooth_lighting orl_lighting_smooth(const struct orl_lighting *lighting,
                                               const struct orl_shaded_ray *shaded,
                                               struct orl_recent_records *recent_records,
                                               struct orl_random *random,
                                               struct orl_search *search);

#endif
