/* The photons, maps and render stages by the plan's technique: backward, or by photon maps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "render/backward/backward.h"
#include "render/gather/direction_sampling.h"
#include "render/gather/sensor_flux.h"
#include "render/image/image.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"
#include "run/stages/run_stages.h"
#include <oriel/base/memory_cache.h>

/* A job by the backward technique: photons for the virtual lights, which belong to this run and are
 * not stored, then sensors and views. */

static void photon_progress(void *ctx, double fraction)
{
    /* The other half is for making virtual lights of the photons. */
    orl_run_report_progress(ctx, 0.5 * fraction);
}

int orl_run_ensure_backward(struct orl_run_state *state, struct orl_error *err)
{
    if (state->backward)
        return 0;
    state->backward = calloc(1, sizeof *state->backward);
    if (!state->backward ||
        orl_backward_init(state->backward, state->lit_scene, state->env->pool) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for light sampling");
    return 0;
}

void orl_run_free_backward(struct orl_run_state *state)
{
    if (state->backward)
        orl_backward_done(state->backward);
    free(state->backward);
    state->backward = NULL;
}

static int put_lamps(struct orl_run_state *state, struct orl_error *err)
{
    const uint64_t lamps = state->result->plan.photons_global;
    struct orl_shot shots[ORL_SHOT_KINDS] = {{0}, {0}};
    int code = orl_run_ensure_emission(state, err);
    if (code == 0)
        code = orl_run_ensure_backward(state, err);
    if (code == 0) {
        orl_run_begin_work(state);
        const struct orl_shoot_env env = {.emission = state->emission,
                                          .seed = state->job->seed,
                                          .pool = state->env->pool,
                                          .cancel = state->env->cancel,
                                          .progress = photon_progress,
                                          .ctx = state};
        shots[ORL_MAP_GLOBAL].target = lamps;
        code = orl_shoot(&env, shots, err);
    }
    orl_health_add(&state->result->health, &shots[ORL_MAP_GLOBAL].health);
    if (code == 0) {
        const struct orl_shot *shot = &shots[ORL_MAP_GLOBAL];
        code = orl_backward_set_vpls(state->backward, state->env->pool, state->job->seed,
                                     shot->photons, shot->count, shot->emitted);
        if (code < 0)
            orl_error_set(err, code,
                          code == ORL_ERR_CANCELLED ? "cancelled"
                                                    : "out of memory for virtual lamps");
    }
    for (int kind = 0; kind < ORL_SHOT_KINDS; kind++)
        free(shots[kind].photons);
    return code;
}

static void compute_backward_sensor(void *ctx, size_t index, uint32_t member,
                                    struct orl_sensor_estimate *ret_found)
{
    struct orl_run_state *state = ctx;
    const struct orl_sensor *sensor = &state->sensors[index];
    const struct orl_sensor_round *round = state->round.sensor_round;
    const struct orl_sample_range range = {.seed = round ? round->seed : state->job->seed,
                                           .index = index,
                                           .first = round ? round->before[index] : 0,
                                           .samples = orl_run_sensor_samples(state, index)};
    struct orl_rgb batches[ORL_MAP_BATCHES];
    const struct orl_estimate e = orl_backward_irradiance(
        state->backward, orl_sub(sensor->position, state->lit_scene->geometry->center),
        orl_normalize(sensor->direction), &range, &state->searches[member].health, batches);
    orl_run_store_sensor(state, index, &e);
    for (uint32_t batch = 0; round && batch < ORL_MAP_BATCHES; batch++)
        round->batches[index * ORL_MAP_BATCHES + batch] =
            ORL_EFFICACY_LM_PER_W * orl_luma(batches[batch]);
    *ret_found = (struct orl_sensor_estimate){e, 0};
}

static void load_backward_sensor(void *ctx, size_t index, const struct orl_sensor_estimate *found)
{
    orl_run_store_sensor(ctx, index, &found->estimate);
}

static int render_backward_view(void *ctx, const struct orl_painting *painting,
                                struct orl_error *err)
{
    const struct orl_run_state *state = ctx;
    return orl_backward_render(state->backward, painting, orl_run_pixel_samples(state),
                               state->job->goal.dgp_error > 0, err);
}

static int orl_run_backward(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_renderer renderer = {.ctx = state,
                                          .compute_sensor = compute_backward_sensor,
                                          .sensor_loaded = load_backward_sensor,
                                          .paint_view = render_backward_view};
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    int code = put_lamps(state, err);
    if (code == 0) {
        state->backward->cancel = state->env->cancel;
        code = orl_run_render(state, &renderer, err);
    }
    return code;
}

/* A job by the techniques of photon maps: maps first, then sensors and views from them. */

/* Seed salt: keeps these random streams distinct from those of maps. */
static const uint64_t sensor_flux_salt = 0x616972;

struct gather_run {
    struct orl_run_state *state;
    struct orl_gather gather;
    struct orl_direction_sampler sampler; /* for the sensors' rays */
    struct orl_sensor_flux *sensor_flux;  /* NULL: nothing redirects light into mid-air */
};

static struct orl_shading_point place_of(const struct gather_run *gather_run, size_t index,
                                         struct orl_surface_point *ret_surface_point)
{
    const struct orl_sensor *sensor = &gather_run->state->sensors[index];
    const struct orl_vec3 center = gather_run->state->lit_scene->geometry->center;
    return orl_gather_sensor_point(&gather_run->gather, orl_sub(sensor->position, center),
                                   orl_normalize(sensor->direction), ret_surface_point);
}

static void compute_gather_sensor(void *ctx, size_t index, uint32_t member,
                                  struct orl_sensor_estimate *ret_found)
{
    const struct gather_run *gather_run = ctx;
    struct orl_run_state *state = gather_run->state;
    const uint32_t samples = orl_run_sensor_samples(state, index);
    struct orl_surface_point surface_point;
    struct orl_shading_point place = place_of(gather_run, index, &surface_point);
    const struct orl_estimate e = orl_gather_sensor(&gather_run->gather, &place, &surface_point,
                                                    samples, index, &state->searches[member]);
    if (gather_run->sensor_flux)
        orl_sensor_flux_set_sensor(gather_run->sensor_flux, index, &place, &e);
    orl_run_store_sensor(state, index, &e);
    *ret_found = (struct orl_sensor_estimate){e, place.in_free_space};
}

static void load_gather_sensor(void *ctx, size_t index, const struct orl_sensor_estimate *found)
{
    const struct gather_run *gather_run = ctx;
    struct orl_surface_point surface_point;
    if (gather_run->sensor_flux) {
        struct orl_shading_point place = place_of(gather_run, index, &surface_point);
        place.in_free_space = found->in_free_space;
        orl_sensor_flux_set_sensor(gather_run->sensor_flux, index, &place, &found->estimate);
    }
    orl_run_store_sensor(gather_run->state, index, &found->estimate);
}

/* Returns the limit as for a requested caustic map. A plan stores fewer photons if a map would show
 * little of them, which says nothing about a single sensor. */
uint64_t orl_run_sensor_flux_limit(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const bool by_plan = state->job->photons_caustic != plan->photons_caustic;
    return by_plan && plan->photons_global > plan->photons_caustic ? plan->photons_global
                                                                   : plan->photons_caustic;
}

/* Returns the ray budget for photons that change no sensor: at most the cost of building and
 * reading the global map. There each photon takes a ray of its own and is indexed and read. */
static double idle_ray_budget(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const double of_a_photon = 2;
    const uint64_t photons = plan->photons_global > 0 ? plan->photons_global : ORL_DEFAULT_PHOTONS;
    return state->job->photons_exact ? INFINITY : of_a_photon * (double)photons;
}

/* Adds caustics at sensors in mid-air, from photons traced for them. */
static int add_sensor_flux(void *ctx, struct orl_error *err)
{
    const struct gather_run *gather_run = ctx;
    struct orl_run_state *state = gather_run->state;
    if (!orl_sensor_flux_is_needed(gather_run->sensor_flux))
        return 0;
    int code = orl_run_ensure_emission(state, err);
    if (code < 0)
        return code;
    const struct orl_shoot_env env = {.emission = state->emission,
                                      .seed = orl_mix64(state->job->seed ^ sensor_flux_salt),
                                      .pool = state->env->pool,
                                      .cancel = state->env->cancel};
    const struct orl_sensor_flux_limits bounds = {orl_run_sensor_flux_limit(state),
                                                  idle_ray_budget(state)};
    const double started = state->env->now_s(state->env->ctx);
    code = orl_sensor_flux_collect(gather_run->sensor_flux, &env, &bounds, &state->result->health);
    orl_run_move_time(state, ORL_STAGE_PHOTONS, state->env->now_s(state->env->ctx) - started);
    if (code < 0)
        return orl_error_set(err, code, "%s",
                             code == ORL_ERR_CANCELLED ? "cancelled while computing sensors"
                                                       : "out of memory for sensors in mid-air");
    for (size_t i = 0; i < state->n_sensors; i++) {
        const struct orl_estimate e = orl_sensor_flux_estimate(gather_run->sensor_flux, i);
        orl_run_store_sensor(state, i, &e);
    }
    return 0;
}

static int render_gather_view(void *ctx, const struct orl_painting *painting, struct orl_error *err)
{
    const struct gather_run *gather_run = ctx;
    return orl_image_render(&gather_run->gather, painting, err);
}

static enum orl_indirect_mode rest_of(enum orl_technique technique)
{
    return technique == ORL_TECHNIQUE_DIRECT        ? ORL_INDIRECT_DENSITY
           : technique == ORL_TECHNIQUE_PRECOMPUTED ? ORL_INDIRECT_PRECOMPUTED
                                                    : ORL_INDIRECT_GATHERED;
}

/*
 * Makes the memory cache key; maps' keys include all that the data depend on: the scene, and the
 * simulation. Returns false if the memory cache is not used: maps of rounds are read once, with
 * their own bandwidths.
 */
static bool cache_key_text(const struct orl_run_state *state, enum orl_indirect_mode indirect,
                           char ret_key[ORL_MEMORY_CACHE_KEY])
{
    const enum orl_map_kind first =
        indirect == ORL_INDIRECT_PRECOMPUTED ? ORL_MAP_PRECOMPUTED : ORL_MAP_GLOBAL;
    snprintf(ret_key, ORL_MEMORY_CACHE_KEY, "gather %d %s %s", (int)indirect,
             state->maps[first] ? state->keys[first] : "none",
             state->maps[ORL_MAP_CAUSTIC] ? state->keys[ORL_MAP_CAUSTIC] : "none");
    return state->env->memory_cache && !state->round.bandwidths && state->maps[first];
}

static void free_gather(void *cached)
{
    orl_gather_done(cached);
    free(cached);
}

/* Takes the data of an earlier job from the memory cache, or computes them. */
static int load_or_make_gather(struct orl_run_state *state, enum orl_indirect_mode indirect,
                               struct orl_gather *ret_gather)
{
    const struct orl_photon_map *maps[ORL_MAP_KINDS];
    char key[ORL_MEMORY_CACHE_KEY];
    int code = 0;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        maps[kind] = state->maps[kind];
    struct orl_gather *cached = cache_key_text(state, indirect, key)
                                    ? orl_memory_cache_take(state->env->memory_cache, key)
                                    : NULL;
    if (cached) {
        *ret_gather = *cached;
        free(cached);
        orl_gather_attach(ret_gather, state->lit_scene, maps, state->job->seed);
        if (ret_gather->leaf_irradiance)
            orl_run_discount_map_reads(state,
                                       orl_leaf_irradiance_filled(ret_gather->leaf_irradiance));
    } else {
        code =
            orl_gather_init(ret_gather, state->lit_scene, indirect, maps, state->round.bandwidths,
                            state->job->seed, state->env->pool, &state->searches[0]);
    }
    if (code == 0 && state->job->n_views > 0)
        code = orl_gather_for_views(ret_gather, state->env->pool);
    return code;
}

static void cache_gather(const struct orl_run_state *state, struct orl_gather *gather)
{
    char key[ORL_MEMORY_CACHE_KEY];
    struct orl_gather *cached =
        cache_key_text(state, gather->indirect, key) ? malloc(sizeof *cached) : NULL;
    if (!cached) {
        orl_gather_done(gather);
        return;
    }
    const uint64_t bytes = orl_gather_detach(gather);
    *cached = *gather;
    orl_memory_cache_put(state->env->memory_cache, key, cached, bytes, free_gather);
}

static int orl_run_gather(struct orl_run_state *state, struct orl_error *err)
{
    struct gather_run gather_run = {.state = state};
    const struct orl_renderer renderer = {.ctx = &gather_run,
                                          .compute_sensor = compute_gather_sensor,
                                          .sensor_loaded = load_gather_sensor,
                                          .finish_sensors = add_sensor_flux,
                                          .paint_view = render_gather_view};
    int code = orl_run_is_dark(state) ? 0 : orl_run_prepare_maps(state, err);
    if (code < 0)
        return code;
    code = load_or_make_gather(state, rest_of(state->result->plan.technique), &gather_run.gather);
    if (code == 0)
        code = orl_sensor_flux_new(&gather_run.gather, state->n_sensors, &gather_run.sensor_flux);
    if (code == 0 && state->n_sensors > 0) {
        code = orl_direction_sampler_init(&gather_run.sampler, state->lit_scene,
                                          &gather_run.gather.sobol, state->env->pool);
        gather_run.gather.sampler = &gather_run.sampler;
    }
    if (code < 0) {
        orl_direction_sampler_done(&gather_run.sampler);
        orl_sensor_flux_free(gather_run.sensor_flux);
        orl_gather_done(&gather_run.gather);
        return orl_error_set(err, code, "%s for the final gather",
                             code == ORL_ERR_CANCELLED ? "cancelled while preparing maps"
                                                       : "out of memory");
    }
    gather_run.gather.cancel = state->env->cancel;
    code = orl_run_render(state, &renderer, err);
    orl_sensor_flux_free(gather_run.sensor_flux);
    orl_direction_sampler_done(&gather_run.sampler);
    cache_gather(state, &gather_run.gather);
    return code;
}

int orl_run_technique(struct orl_run_state *state, struct orl_error *err)
{
    return state->result->plan.technique == ORL_TECHNIQUE_BACKWARD ? orl_run_backward(state, err)
                                                                   : orl_run_gather(state, err);
}
