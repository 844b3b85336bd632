/*
 * Backward path tracing (technique backward; xxx in Grobe 2019).
 *
 * Estimates irradiance without bias, from the sensor or the eye, with no stored map and no density
 * estimate. It is the reference for the other techniques.
 *
 * Estimator: irradiance at x is the mean of samples. A sample is the sum
 *   E(x) = E_direct(x) + E_sampled(x) + E_connected(x)
 *   E_direct    = sum over suns, lamps and their images in flat mirrors:
 *                 L_e V cos / p, one shadow ray to each;
 *   E_sampled   = sum_j L(x, w_j) cos_j / sum_s n_s p_s(w_j), rays drawn by strategies s:
 *                 by the cosine, at ports, along sun lobes of panes, at small mirrors and lenses.
 *                 L is the light of skies and glows, and of suns and lamps through the lobes of
 *                 the surfaces met, mainly BSDF panes;
 *   E_connected = sum_k min(g, g_max) V I_k / q_k, connections to a few virtual point lights k
 *                 (Keller 1997) of intensity I_k, each chosen with an expected number q_k;
 *                 g = cos cos / distance^2. It is the light from all diffuse surfaces.
 * The part 1 - g_max / g that the cap cuts off from near surfaces is added by the rays of E_sampled
 * that meet them (Kollig and Keller 2004). V is 1 if the connection is unobstructed. Every light
 * path belongs to exactly one of the three sums. Weights of rays are the multi-sample balance
 * heuristic (Veach 1997, section 9.2). Weak paths undergo Russian roulette.
 *
 * Bias: none. Suns and lamps reached by a curved mirror, a dielectric or several mirrors have no
 * shadow rays: only a ray that hits the light by chance finds them. That is variance, not bias, but
 * few jobs have enough samples to notice it. Photons therefore measure such light at the sensors,
 * intervals are widened to include it, and a warning names the sensors that lack it.
 *
 * Variance: with S samples and L virtual lights it is in proportion to 1 / S + b / L, because all
 * samples share the lights (plan/choose_technique.c). Samples fall into 16 groups, with random
 * numbers and virtual lights of their own; the spread of the groups gives the standard error. For
 * views, render/backward/backward.h describes the groups of a pixel's samples.
 *
 * References: Veach 1997; Keller 1997; Kollig and Keller 2004; Yuksel 2019 (choice of lights,
 * render/gather/vpl.h); Grobe 2019.
 */
#include <stdlib.h>

#include "render/backward/backward.h"
#include "render/technique/technique.h"

struct backward {
    struct orl_backward backward;
    const struct orl_technique_input *input; /* borrowed, from prepare on */
};

static void destroy_backward(void *technique)
{
    struct backward *b = technique;
    if (b)
        orl_backward_done(&b->backward);
    free(b);
}

static int create_backward(const struct orl_technique_definition *definition,
                           const struct orl_lit_scene *lit_scene, struct orl_thread_pool *pool,
                           void **ret_technique, struct orl_error *err)
{
    (void)definition;
    struct backward *b = calloc(1, sizeof *b);
    *ret_technique = b;
    if (b && orl_backward_init(&b->backward, lit_scene, pool) == 0)
        return 0;
    destroy_backward(b);
    *ret_technique = NULL;
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for light sampling");
}

/* ---- Virtual point lights, which belong to this run and are not stored ----------------------- */

static void report_photons(void *ctx, double fraction)
{
    const struct backward *b = ctx;
    const struct orl_technique_input *input = b->input;
    /* The other half is for making virtual lights of the photons. */
    input->report_progress(input->ctx, 0.5 * fraction);
}

static int shoot_photons(struct backward *b, struct orl_shot *shots, struct orl_error *err)
{
    const struct orl_technique_input *input = b->input;
    struct orl_shoot_env env = {.seed = input->seed,
                                .pool = input->pool,
                                .cancel = input->cancel,
                                .progress = report_photons,
                                .ctx = b};
    int code = input->get_emission(input->ctx, &env.emission, err);
    shots[ORL_MAP_GLOBAL].target = input->virtual_lights;
    if (code == 0)
        code = orl_shoot(&env, shots, err);
    orl_health_add(input->health, &shots[ORL_MAP_GLOBAL].health);
    return code;
}

static int make_virtual_lights(struct backward *b, struct orl_error *err)
{
    const struct orl_technique_input *input = b->input;
    struct orl_shot shots[ORL_SHOT_KINDS] = {{0}, {0}};
    const struct orl_shot *shot = &shots[ORL_MAP_GLOBAL];
    int code = shoot_photons(b, shots, err);
    if (code == 0) {
        code = orl_backward_set_vpls(&b->backward, input->pool, input->seed, shot->photons,
                                     shot->count, shot->emitted);
        if (code < 0)
            orl_error_set(err, code,
                          code == ORL_ERR_CANCELLED ? "cancelled"
                                                    : "out of memory for virtual lamps");
    }
    for (int kind = 0; kind < ORL_SHOT_KINDS; kind++)
        free(shots[kind].photons);
    return code;
}

static int prepare_backward(void *technique, const struct orl_technique_input *input,
                            struct orl_error *err)
{
    struct backward *b = technique;
    b->input = input;
    b->backward.cancel = input->cancel;
    return make_virtual_lights(b, err);
}

/* ---- Sensors and views ----------------------------------------------------------------------- */

static void compute_sensor(void *technique, const struct orl_sensor_query *query,
                           struct orl_sensor_estimate *ret_found,
                           struct orl_rgb ret_batches[ORL_MAP_BATCHES])
{
    const struct backward *b = technique;
    const struct orl_sample_range range = {.seed = query->seed,
                                           .index = query->index,
                                           .first = query->first,
                                           .samples = query->samples};
    ret_found->estimate = orl_backward_irradiance(&b->backward, query->position, query->normal,
                                                  &range, &query->search->health, ret_batches);
    ret_found->in_free_space = 0;
}

static int paint_view(void *technique, const struct orl_painting *painting, struct orl_error *err)
{
    const struct backward *b = technique;
    return orl_backward_render(&b->backward, painting, b->input->pixel_samples,
                               b->input->sums_of_pixels, err);
}

static const struct orl_technique_methods methods = {.create = create_backward,
                                                     .prepare = prepare_backward,
                                                     .compute_sensor = compute_sensor,
                                                     .paint_view = paint_view,
                                                     .destroy = destroy_backward};

const struct orl_technique_definition orl_backward_technique = {
    .facts = {.name = "backward",
              .alternative = ORL_TECHNIQUE_GATHER,
              .samples_paths = true,
              .photons = ORL_PHOTONS_FOR_VPLS,
              .final_gather = ORL_GATHER_NOWHERE},
    .methods = &methods};
