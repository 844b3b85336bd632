#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/stages.h"

enum { DEFAULT_GATHER_SAMPLES = 4096 };

struct sensor_work {
    const struct orl_run_state *state;
    const struct orl_gather *gather;
    size_t first, count;
};

static void compute_sensor(void *arg, size_t index, uint32_t member)
{
    const struct sensor_work *work = arg;
    const struct orl_run_state *state = work->state;
    const size_t i = work->first + index;
    const uint32_t samples =
        state->job->gather_samples ? state->job->gather_samples : DEFAULT_GATHER_SAMPLES;
    if (atomic_load_explicit(state->env->cancel, memory_order_relaxed))
        return;
    state->result->illuminance_lx[i] = orl_gather_sensor(
        work->gather, orl_sub(state->sensors[i].position, state->world->geometry->center),
        orl_normalize(state->sensors[i].direction), samples, i, &state->searches[member]);
}

/* Rounds of a few hundred sensors, so that progress and cancelling are heard in between. */
static int render_sensors(struct orl_run_state *state, const struct orl_gather *gather,
                          double share, struct orl_error *err)
{
    enum { ROUND = 128 };
    const size_t n = state->n_sensors;
    if (n == 0)
        return 0;
    state->result->illuminance_lx = calloc(n, sizeof *state->result->illuminance_lx);
    if (!state->result->illuminance_lx)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    state->result->n_sensors = n;
    for (size_t first = 0; first < n; first += ROUND) {
        struct sensor_work work = {state, gather, first, n - first < ROUND ? n - first : ROUND};
        orl_crew_for(state->env->crew, work.count, compute_sensor, &work);
        if (atomic_load(state->env->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while computing sensors");
        orl_run_progress(state, share * (double)(first + work.count) / (double)n);
    }
    return 0;
}

int orl_run_render(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_gather gather;
    const struct orl_photon_map *maps[ORL_MAP_KINDS] = {state->maps[ORL_MAP_GLOBAL],
                                                        state->maps[ORL_MAP_CAUSTIC]};
    int code = orl_gather_init(&gather, state->world, maps, state->job->seed, &state->searches[0]);
    if (code < 0)
        return orl_error_set(err, code, "out of memory for the final gather");
    code = render_sensors(state, &gather, 1, err);
    orl_gather_done(&gather);
    return code;
}
