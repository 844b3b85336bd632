#include "render/backward/backward.h"
#include "scene/geometry/stand.h"

enum { LAMPS_A_SAMPLE = 8 };
/* Rays per strategy: for a sensor's sample, and for a surface that one of its rays meets. */
static const struct orl_effort at_sensors = {{1, 1, 1, 0.5}}, deeper = {{1, 1, 0.5, 0.25}};

int orl_backward_init(struct orl_backward *backward, const struct orl_world *world,
                      struct orl_crew *crew)
{
    *backward = (struct orl_backward){.world = world};
    orl_sobol_init(&backward->sobol);
    const int code = orl_aim_init(&backward->aim, world, &backward->sobol, crew);
    backward->deep = orl_aim_effort(&backward->aim, deeper);
    return code;
}

int orl_backward_put_lamps(struct orl_backward *backward, struct orl_crew *crew, uint64_t seed,
                           const struct orl_photon *photons, size_t count, uint64_t emitted)
{
    orl_vpls_done(&backward->vpls);
    backward->seed = seed;
    return orl_vpls_init(&backward->vpls, backward->world, crew, photons, count, emitted);
}

void orl_backward_done(struct orl_backward *backward)
{
    orl_aim_done(&backward->aim);
    orl_vpls_done(&backward->vpls);
}

/* Returns the mean of one group's samples; rays receives each sample's contribution to the
 * sensor. */
static struct orl_rgb sample_group(const struct orl_backward *b, const struct orl_place *place,
                                   const struct orl_span *span, uint32_t group,
                                   struct orl_health *health, struct orl_rays *rays)
{
    const uint32_t first = span->first / ORL_MAP_BATCHES;
    const uint32_t samples =
        span->samples / ORL_MAP_BATCHES > 0 ? span->samples / ORL_MAP_BATCHES : 1;
    const uint64_t name = span->index * ORL_MAP_BATCHES + group;
    struct orl_sampling sampling = {.sequence =
                                        (uint32_t)orl_mix64(span->seed ^ orl_mix64(name + 1)),
                                    .effort = orl_aim_effort(&b->aim, at_sensors),
                                    .lamps = LAMPS_A_SAMPLE};
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = first; i < first + samples && !orl_is_cancelled(b->cancel); i++) {
        struct orl_tracer tracer = {
            .backward = b,
            .group = group,
            .random = orl_random_stream(span->seed, ORL_PURPOSE_SENSOR, (name << 24) + i),
            .health = health};
        sampling.index = i;
        const struct orl_rgb light =
            orl_health_keep(health, orl_backward_light(&tracer, place, &sampling));
        orl_rays_add(rays, orl_luma(light) / samples / ORL_MAP_BATCHES);
        sum = orl_rgb_add(sum, light);
    }
    return orl_rgb_scale(sum, 1.0 / samples);
}

struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            const struct orl_span *span, struct orl_health *health,
                                            struct orl_rgb ret_groups[ORL_MAP_BATCHES])
{
    const struct orl_world *world = backward->world;
    struct orl_place place = {.point = orl_stand(world->geometry, position, normal),
                              .normal = normal};
    place.outside = orl_world_is_outside(world, place.point);
    struct orl_rays rays = {0, 0};
    for (uint32_t group = 0; group < ORL_MAP_BATCHES; group++)
        ret_groups[group] = sample_group(backward, &place, span, group, health, &rays);
    struct orl_estimate estimate = orl_estimate_of_mean(ret_groups, ORL_MAP_BATCHES);
    estimate.rays = rays;
    return estimate;
}
