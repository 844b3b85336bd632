/*
 * A job by the backward technique: photons for the virtual lamps, which are of this run alone and
 * go to no store, then sensors.
 */
#include <stdlib.h>

#include "render/backward.h"
#include "run/stages.h"

/* More lamps than samples connect to are of no use. */
enum { MOST_LAMPS = 1000000, SENSORS_A_ROUND = 64 };

struct work {
    struct orl_run_state *state;
    struct orl_backward backward;
    size_t first;
};

static bool cancelled(const struct work *work)
{
    return atomic_load_explicit(work->state->env->cancel, memory_order_relaxed);
}

static void photon_progress(void *ctx, double fraction)
{
    orl_run_progress(ctx, fraction);
}

static int prepare(struct work *work, struct orl_error *err)
{
    struct orl_run_state *state = work->state;
    const struct orl_job *job = state->job;
    struct orl_emission *emission = NULL;
    struct orl_shot shots[ORL_MAP_KINDS] = {{0}, {0}};
    int code = orl_emission_new(state->world, job->seed, state->env->crew, &emission, err);
    if (code == 0) {
        const struct orl_shoot_env env = {.emission = emission,
                                          .seed = job->seed,
                                          .crew = state->env->crew,
                                          .cancel = state->env->cancel,
                                          .progress = photon_progress,
                                          .ctx = state};
        shots[ORL_MAP_GLOBAL].target =
            job->photons_global < MOST_LAMPS ? job->photons_global : MOST_LAMPS;
        code = orl_shoot(&env, shots, err);
    }
    if (code == 0) {
        const struct orl_shot *shot = &shots[ORL_MAP_GLOBAL];
        orl_health_add(&state->result->health, &shot->health);
        code = orl_backward_init(&work->backward, state->world, job->seed, shot->photons,
                                 shot->count, shot->emitted);
        if (code < 0)
            orl_error_set(err, code, "out of memory for virtual lamps");
    }
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        free(shots[kind].photons);
    orl_emission_free(emission);
    return code;
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static void compute_sensor(void *arg, size_t index, uint32_t member)
{
    const struct work *work = arg;
    struct orl_run_state *state = work->state;
    const size_t i = work->first + index;
    const uint32_t samples =
        state->job->gather_samples ? state->job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    const struct orl_vec3 normal = orl_normalize(state->sensors[i].direction);
    const struct orl_vec3 at = orl_sub(state->sensors[i].position, state->world->geometry->center);
    if (cancelled(work))
        return;
    const struct orl_estimate e = orl_backward_irradiance(&work->backward, at, normal, samples, i,
                                                          &state->searches[member].health);
    state->result->illuminance_lx[i] = ORL_EFFICACY_LM_PER_W * orl_luma(e.value);
    state->result->standard_error_lx[i] = ORL_EFFICACY_LM_PER_W * e.standard_error;
}

static int compute_sensors(struct work *work, struct orl_error *err)
{
    struct orl_run_state *state = work->state;
    const size_t n = state->n_sensors;
    state->result->illuminance_lx = calloc(n + 1, sizeof(double));
    state->result->standard_error_lx = calloc(n + 1, sizeof(double));
    if (!state->result->illuminance_lx || !state->result->standard_error_lx)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    state->result->n_sensors = n;
    for (work->first = 0; work->first < n; work->first += SENSORS_A_ROUND) {
        const size_t left = n - work->first;
        orl_crew_for(state->env->crew, left < SENSORS_A_ROUND ? left : SENSORS_A_ROUND,
                     compute_sensor, work);
        if (cancelled(work))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while computing sensors");
        orl_run_progress(state, (double)work->first / (double)n);
    }
    return 0;
}

int orl_run_backward(struct orl_run_state *state, struct orl_error *err)
{
    struct work work = {.state = state};
    orl_run_enter(state, ORL_STAGE_PHOTONS);
    int code = prepare(&work, err);
    if (code == 0) {
        orl_run_enter(state, ORL_STAGE_RENDER);
        code = compute_sensors(&work, err);
    }
    orl_backward_done(&work.backward);
    for (uint32_t i = 0; i < orl_crew_size(state->env->crew); i++)
        orl_health_add(&state->result->health, &state->searches[i].health);
    return code;
}
