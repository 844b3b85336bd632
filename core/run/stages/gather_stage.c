/* A job by the techniques of photon maps: maps first, then sensors and views from them. */
#include "run/stages.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "base/shelf.h"
#include "render/gather/aim.h"
#include "render/gather/air.h"
#include "render/image/image.h"

/* Seed salt: keeps these random streams distinct from those of maps. */
static const uint64_t photons_in_air = 0x616972;

struct work {
    struct orl_run_state *state;
    struct orl_gather gather;
    struct orl_aim aim;  /* for the sensors' rays */
    struct orl_air *air; /* NULL: nothing redirects light into mid-air */
};

static struct orl_place place_of(const struct work *work, size_t index,
                                 struct orl_footing *ret_footing)
{
    const struct orl_sensor *sensor = &work->state->sensors[index];
    const struct orl_vec3 center = work->state->world->geometry->center;
    return orl_gather_place(&work->gather, orl_sub(sensor->position, center),
                            orl_normalize(sensor->direction), ret_footing);
}

static void compute_sensor(void *ctx, size_t index, uint32_t member,
                           struct orl_sensor_found *ret_found)
{
    const struct work *work = ctx;
    struct orl_run_state *state = work->state;
    const uint32_t samples = orl_run_sensor_samples(state, index);
    struct orl_footing footing;
    struct orl_place place = place_of(work, index, &footing);
    const struct orl_estimate e = orl_gather_sensor(&work->gather, &place, &footing, samples, index,
                                                    &state->searches[member]);
    if (work->air)
        orl_air_put(work->air, index, &place, &e);
    orl_run_book_sensor(state, index, &e);
    *ret_found = (struct orl_sensor_found){e, place.in_air};
}

static void take_sensor(void *ctx, size_t index, const struct orl_sensor_found *found)
{
    const struct work *work = ctx;
    struct orl_footing footing;
    if (work->air) {
        struct orl_place place = place_of(work, index, &footing);
        place.in_air = found->in_air;
        orl_air_put(work->air, index, &place, &found->estimate);
    }
    orl_run_book_sensor(work->state, index, &found->estimate);
}

/* Returns the limit as for a requested caustic map. A plan stores fewer photons if a map would show
 * little of them, which says nothing about a single sensor. */
uint64_t orl_run_most_in_air(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const bool by_plan = state->job->photons_caustic != plan->photons_caustic;
    return by_plan && plan->photons_global > plan->photons_caustic ? plan->photons_global
                                                                   : plan->photons_caustic;
}

/* Returns the ray budget for photons that change no sensor: at most the cost of building and
 * reading the global map. There each photon takes a ray of its own and is indexed and read. */
static double rays_not_felt(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const double of_a_photon = 2;
    const uint64_t photons = plan->photons_global > 0 ? plan->photons_global : ORL_DEFAULT_PHOTONS;
    return state->job->photons_exact ? INFINITY : of_a_photon * (double)photons;
}

/* Adds caustics at sensors in mid-air, from photons traced for them. */
static int catch_in_air(void *ctx, struct orl_error *err)
{
    const struct work *work = ctx;
    struct orl_run_state *state = work->state;
    if (!orl_air_is_needed(work->air))
        return 0;
    int code = orl_run_need_emission(state, err);
    if (code < 0)
        return code;
    const struct orl_shoot_env env = {.emission = state->emission,
                                      .seed = orl_mix64(state->job->seed ^ photons_in_air),
                                      .crew = state->env->crew,
                                      .cancel = state->env->cancel};
    const struct orl_air_bounds bounds = {orl_run_most_in_air(state), rays_not_felt(state)};
    const double started = state->env->now_s(state->env->ctx);
    code = orl_air_catch(work->air, &env, &bounds, &state->result->health);
    orl_run_book(state, ORL_STAGE_PHOTONS, state->env->now_s(state->env->ctx) - started);
    if (code < 0)
        return orl_error_set(err, code, "%s",
                             code == ORL_ERR_CANCELLED ? "cancelled while computing sensors"
                                                       : "out of memory for sensors in mid-air");
    for (size_t i = 0; i < state->n_sensors; i++) {
        const struct orl_estimate e = orl_air_estimate(work->air, i);
        orl_run_book_sensor(state, i, &e);
    }
    return 0;
}

static int render_view(void *ctx, const struct orl_painting *painting, struct orl_error *err)
{
    const struct work *work = ctx;
    return orl_image_render(&work->gather, painting, err);
}

static enum orl_rest rest_of(enum orl_technique technique)
{
    return technique == ORL_TECHNIQUE_DIRECT        ? ORL_REST_DENSITY
           : technique == ORL_TECHNIQUE_PRECOMPUTED ? ORL_REST_RECORDS
                                                    : ORL_REST_GATHERED;
}

/*
 * Makes the shelf key; maps' keys include all that the data depend on: the scene, and the
 * simulation. Returns false if the shelf is not used: maps of rounds are read once, with their own
 * bandwidths.
 */
static bool shelf_key(const struct orl_run_state *state, enum orl_rest rest,
                      char ret_key[ORL_SHELF_KEY])
{
    const enum orl_map_kind first = rest == ORL_REST_RECORDS ? ORL_MAP_PRECOMPUTED : ORL_MAP_GLOBAL;
    snprintf(ret_key, ORL_SHELF_KEY, "gather %d %s %s", (int)rest,
             state->maps[first] ? state->keys[first] : "none",
             state->maps[ORL_MAP_CAUSTIC] ? state->keys[ORL_MAP_CAUSTIC] : "none");
    return state->env->shelf && !state->bandwidths && state->maps[first];
}

static void free_gather(void *kept)
{
    orl_gather_done(kept);
    free(kept);
}

/* Takes the data of an earlier job from the shelf, or computes them. */
static int take_or_make_gather(struct orl_run_state *state, enum orl_rest rest,
                               struct orl_gather *ret_gather)
{
    const struct orl_photon_map *maps[ORL_MAP_KINDS];
    char key[ORL_SHELF_KEY];
    int code = 0;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        maps[kind] = state->maps[kind];
    struct orl_gather *kept =
        shelf_key(state, rest, key) ? orl_shelf_take(state->env->shelf, key) : NULL;
    if (kept) {
        *ret_gather = *kept;
        free(kept);
        orl_gather_resume(ret_gather, state->world, maps, state->job->seed);
        if (ret_gather->leaves)
            orl_run_know_reads(state, orl_leaves_made(ret_gather->leaves));
    } else {
        code = orl_gather_init(ret_gather, state->world, rest, maps, state->bandwidths,
                               state->job->seed, state->env->crew, &state->searches[0]);
    }
    if (code == 0 && state->job->n_views > 0)
        code = orl_gather_for_views(ret_gather, state->env->crew);
    return code;
}

static void shelve_gather(const struct orl_run_state *state, struct orl_gather *gather)
{
    char key[ORL_SHELF_KEY];
    struct orl_gather *kept = shelf_key(state, gather->rest, key) ? malloc(sizeof *kept) : NULL;
    if (!kept) {
        orl_gather_done(gather);
        return;
    }
    const uint64_t bytes = orl_gather_pause(gather);
    *kept = *gather;
    orl_shelf_put(state->env->shelf, key, kept, bytes, free_gather);
}

int orl_run_gather(struct orl_run_state *state, struct orl_error *err)
{
    struct work work = {.state = state};
    const struct orl_renderer renderer = {.ctx = &work,
                                          .sensor = compute_sensor,
                                          .sensor_found = take_sensor,
                                          .sensors = catch_in_air,
                                          .view = render_view};
    int code = orl_run_is_dark(state) ? 0 : orl_run_maps(state, err);
    if (code < 0)
        return code;
    code = take_or_make_gather(state, rest_of(state->result->plan.technique), &work.gather);
    if (code == 0)
        code = orl_air_new(&work.gather, state->n_sensors, &work.air);
    if (code == 0 && state->n_sensors > 0) {
        code = orl_aim_init(&work.aim, state->world, &work.gather.sobol, state->env->crew);
        work.gather.aim = &work.aim;
    }
    if (code < 0) {
        orl_aim_done(&work.aim);
        orl_air_free(work.air);
        orl_gather_done(&work.gather);
        return orl_error_set(err, code, "%s for the final gather",
                             code == ORL_ERR_CANCELLED ? "cancelled while preparing maps"
                                                       : "out of memory");
    }
    work.gather.cancel = state->env->cancel;
    code = orl_run_render(state, &renderer, err);
    orl_air_free(work.air);
    orl_aim_done(&work.aim);
    shelve_gather(state, &work.gather);
    return code;
}
