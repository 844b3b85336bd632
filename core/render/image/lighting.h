/*
 * The light at the diffuse surfaces that a view's ray comes to, from photon maps and records, in
 * two parts: what may change at once, along the edges of shadows, and is to be asked for at every
 * ray; and what is smooth along a surface, which one place can say for those about it.
 */
#ifndef ORL_RENDER_IMAGE_LIGHTING_H
#define ORL_RENDER_IMAGE_LIGHTING_H

#include "render/gather/record.h"
#include "render/image/shade.h"

struct orl_lighting {
    const struct orl_gather *gather; /* borrowed, as is the cache */
    const struct orl_icache *cache;
    struct orl_grain grain;
    uint32_t shadow_rays; /* a ray and light */
};

/*
 * Records of places that none of the cache's reach, things that no pixel's middle shows: those made
 * last. A tile has its own. Empty at first.
 */
enum { ORL_STRAYS = 64 };
struct orl_strays {
    struct orl_record records[ORL_STRAYS];
    uint32_t made;
};

/* Whether the rest is gathered there: where photons land, some techniques read them. */
static inline bool orl_lighting_gathers(const struct orl_gather *gather,
                                        const struct orl_place *place)
{
    return gather->rest == ORL_REST_GATHERED || place->outside;
}

/* How much of the rest at a place is gathered even so, of 0 to 1, where the records that are read
 * differ: in dark places beside lit ones, which they are too wide to tell apart. */
double orl_lighting_doubt(const struct orl_density *read);

/* Direct light by way of all surfaces that a ray saw: radiance. */
struct orl_shadowed {
    struct orl_rgb radiance;
    double variance; /* of its luma: of the shadow rays, where there are several */
};
struct orl_shadowed orl_lighting_direct(const struct orl_lighting *lighting,
                                        const struct orl_shaded *shaded, uint32_t sequence,
                                        uint32_t first, struct orl_health *health);

/* Caustics and the rest: radiance, and the standard errors of its luma by either. */
struct orl_smooth {
    struct orl_rgb radiance;
    double rest_error, caustic_error;
    double reach; /* about the first surface's point: so far it is sure to be much the same */
};
struct orl_smooth orl_lighting_smooth(const struct orl_lighting *lighting,
                                      const struct orl_shaded *shaded, struct orl_strays *strays,
                                      struct orl_random *random, struct orl_search *search);

#endif
