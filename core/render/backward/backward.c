#include "render/backward/backward.h"
#include "scene/geometry/surface_offset.h"

enum { LAMPS_A_SAMPLE = 8 };
/* Rays per strategy: for a sensor's sample, and for a surface that one of its rays meets. */
static const struct orl_strategy_counts at_sensors = {{1, 1, 1, 0.5}}, deeper = {{1, 1, 0.5, 0.25}};

int orl_backward_init(struct orl_backward *backward, const struct orl_lit_scene *lit_scene,
                      struct orl_thread_pool *pool)
{
    *backward = (struct orl_backward){.lit_scene = lit_scene};
    orl_sobol_init(&backward->sobol);
    const int code =
        orl_direction_sampler_init(&backward->sampler, lit_scene, &backward->sobol, pool);
    backward->bounce_counts = orl_direction_sampler_counts(&backward->sampler, deeper);
    return code;
}

int orl_backward_set_vpls(struct orl_backward *backward, struct orl_thread_pool *pool,
                          uint64_t seed, const struct orl_photon *photons, size_t count,
                          uint64_t emitted)
{
    orl_vpls_done(&backward->vpls);
    backward->seed = seed;
    return orl_vpls_init(&backward->vpls, backward->lit_scene, pool, photons, count, emitted);
}

void orl_backward_done(struct orl_backward *backward)
{
    orl_direction_sampler_done(&backward->sampler);
    orl_vpls_done(&backward->vpls);
}

/* Returns the mean of one group's samples; rays receives each sample's contribution to the
 * sensor. */
static struct orl_rgb sample_group(const struct orl_backward *b,
                                   const struct orl_shading_point *place,
                                   const struct orl_sample_range *range, uint32_t group,
                                   struct orl_health *health, struct orl_ray_moments *rays)
{
    const uint32_t first = range->first / ORL_MAP_BATCHES;
    const uint32_t samples =
        range->samples / ORL_MAP_BATCHES > 0 ? range->samples / ORL_MAP_BATCHES : 1;
    const uint64_t name = range->index * ORL_MAP_BATCHES + group;
    struct orl_sample_params params = {
        .sequence = (uint32_t)orl_mix64(range->seed ^ orl_mix64(name + 1)),
        .ray_counts = orl_direction_sampler_counts(&b->sampler, at_sensors),
        .lamps = LAMPS_A_SAMPLE};
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = first; i < first + samples && !orl_is_cancelled(b->cancel); i++) {
        struct orl_tracer tracer = {
            .backward = b,
            .group = group,
            .random = orl_random_stream(range->seed, ORL_PURPOSE_SENSOR, (name << 24) + i),
            .health = health};
        params.index = i;
        const struct orl_rgb light =
            orl_health_filter(health, orl_backward_sample_irradiance(&tracer, place, &params));
        orl_ray_moments_add(rays, orl_luma(light) / samples / ORL_MAP_BATCHES);
        sum = orl_rgb_add(sum, light);
    }
    return orl_rgb_scale(sum, 1.0 / samples);
}

struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            const struct orl_sample_range *range,
                                            struct orl_health *health,
                                            struct orl_rgb ret_groups[ORL_MAP_BATCHES])
{
    const struct orl_lit_scene *lit_scene = backward->lit_scene;
    struct orl_shading_point place = {
        .point = orl_offset_from_surface(lit_scene->geometry, position, normal), .normal = normal};
    place.outside = orl_lit_scene_is_outside(lit_scene, place.point);
    struct orl_ray_moments rays = {0, 0};
    for (uint32_t group = 0; group < ORL_MAP_BATCHES; group++)
        ret_groups[group] = sample_group(backward, &place, range, group, health, &rays);
    struct orl_estimate estimate = orl_estimate_of_mean(ret_groups, ORL_MAP_BATCHES);
    estimate.rays = rays;
    return estimate;
}
