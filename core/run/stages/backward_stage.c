/* A job by the backward technique: photons for the virtual lights, which belong to this run and are
 * not stored, then sensors and views. */
#include <stdlib.h>

#include "render/backward/backward.h"
#include "run/estimate/stage_progress.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"
#include "run/stages/sensor_results.h"

static void photon_progress(void *ctx, double fraction)
{
    orl_run_report_progress(ctx, 0.5 * fraction); /* the other half is for making lights of them */
}

int orl_run_ensure_backward(struct orl_run_state *state, struct orl_error *err)
{
    if (state->backward)
        return 0;
    state->backward = calloc(1, sizeof *state->backward);
    if (!state->backward ||
        orl_backward_init(state->backward, state->lit_scene, state->env->pool) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for aims at the light");
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

static void compute_sensor(void *ctx, size_t index, uint32_t member,
                           struct orl_sensor_estimate *ret_found)
{
    struct orl_run_state *state = ctx;
    const struct orl_sensor *sensor = &state->sensors[index];
    const struct orl_sensor_round *round = state->sensor_round;
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

static void load_sensor(void *ctx, size_t index, const struct orl_sensor_estimate *found)
{
    orl_run_store_sensor(ctx, index, &found->estimate);
}

static int render_view(void *ctx, const struct orl_painting *painting, struct orl_error *err)
{
    const struct orl_run_state *state = ctx;
    return orl_backward_render(state->backward, painting, orl_run_pixel_samples(state),
                               state->job->goal.dgp_error > 0, err);
}

int orl_run_backward(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_renderer renderer = {
        .ctx = state, .sensor = compute_sensor, .sensor_loaded = load_sensor, .view = render_view};
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    int code = put_lamps(state, err);
    if (code == 0) {
        state->backward->cancel = state->env->cancel;
        code = orl_run_render(state, &renderer, err);
    }
    return code;
}
