/*
 * Samples of the backward technique, whose estimator render/technique/backward_technique.c
 * describes: shadow rays, importance-sampled rays (direction_sampling.h), and connections to
 * virtual point lights (vpl.h).
 *
 * Sensors: samples fall into 16 groups. Each group has its own random numbers and its own virtual
 * lights, from emissions independent of the other groups'. The spread of the groups gives the
 * standard error.
 * Views: both rays are followed where a ray splits (shade.h), and one sample is taken at every
 * diffuse surface that they meet. Branches of little weight undergo Russian roulette. A pixel's
 * samples fall into up to 16 groups of consecutive ones, each with its own virtual lights. Their
 * spread, smoothed over neighbours (render/picture/false_color.h), gives the standard error. It is
 * an overestimate: the samples of all groups are stratified together, those of one group are not.
 * With one sample a pixel the error is unknown.
 *
 * Exterior paths are traced by exterior.h until they enter a building. Rays meet BSDFs with a
 * thickness as light does; only the views' own rays see the geometry that the BSDF stands for.
 */
#ifndef ORL_RENDER_BACKWARD_BACKWARD_H
#define ORL_RENDER_BACKWARD_BACKWARD_H

#include "base/sampling/sampling.h"
#include "render/gather/direction_sampling.h"
#include "render/gather/gather.h"
#include "render/gather/vpl.h"
#include "render/image/image.h"

struct orl_backward {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_vpls vpls;
    struct orl_direction_sampler sampler;
    struct orl_strategy_counts
        bounce_counts; /* rays per strategy at the surfaces that a ray meets */
    struct orl_sobol sobol;
    uint64_t seed; /* random seed of views */
    /* If set, ends a sensor's sampling, whose value is then invalid; may be NULL. */
    const atomic_bool *cancel;
};

/* Initialises all that depends on the lit scene alone, without virtual lights. Returns 0 or
 * ORL_ERR_NOMEM; call orl_backward_done in either case. */
int orl_backward_init(struct orl_backward *backward, const struct orl_lit_scene *lit_scene,
                      struct orl_thread_pool *pool);
void orl_backward_done(struct orl_backward *backward); /* also accepts an all-zero struct */

/* Replaces the virtual lights by ones made from photons, which are copied, and sets the seed of
 * views. Returns 0, ORL_ERR_NOMEM or the codes of orl_parallel_try. */
int orl_backward_set_vpls(struct orl_backward *backward, struct orl_thread_pool *pool,
                          uint64_t seed, const struct orl_photon *photons, size_t count,
                          uint64_t emitted);

/* A range of a sensor's samples: seed and index name its sequences, first is the first sample. */
struct orl_sample_range {
    uint64_t seed, index;
    uint32_t first, samples; /* multiples of ORL_MAP_BATCHES, or fewer */
};

/*
 * Estimates the irradiance on a plane at a position, with unit normal, both in moved coordinates.
 * ret_groups receives each group's mean. Consecutive ranges are together as well stratified as one,
 * even if their virtual lights differ. Counts into health.
 */
struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            const struct orl_sample_range *range,
                                            struct orl_health *health,
                                            struct orl_rgb ret_groups[ORL_MAP_BATCHES]);

/*
 * Renders a view with that many rays a pixel. of_sums: the result is a sum over many pixels, such
 * as glare, so that each ray gets fewer samples than for a picture. Returns 0 or ORL_ERR_CANCELLED.
 */
int orl_backward_render(const struct orl_backward *backward, const struct orl_painting *painting,
                        uint32_t samples, bool of_sums, struct orl_error *err);

/* ---- One sample ------------------------------------------------------------------------------ */

/* State shared by the paths of one sample. */
struct orl_tracer {
    const struct orl_backward *backward;
    uint32_t group; /* group of virtual lights that light it */
    struct orl_random random;
    struct orl_health *health;
};

/* Parameters of a sample at a place. Its first random numbers are points of Sobol sequences. */
struct orl_sample_params {
    uint32_t sequence, index;
    struct orl_strategy_counts ray_counts;
    uint32_t lamps;
};

/* Returns one estimate of the irradiance at a place. */
struct orl_rgb orl_backward_sample_irradiance(struct orl_tracer *tracer,
                                              const struct orl_shading_point *place,
                                              const struct orl_sample_params *params);

/* Returns one estimate of the radiance along a ray that a lobe has scattered; suns seen directly
 * are left out. */
struct orl_rgb orl_backward_radiance(struct orl_tracer *tracer, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside,
                                     struct orl_mis_pdf mis_pdf);

#endif
