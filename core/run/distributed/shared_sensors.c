/* Distributes chunks of sensors as tasks of a job. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/run_state.h"
#include "run/stages/rendering.h"
#include "run/stages/sensor_results.h"

/* Layout of a chunk's file: this header, the results of the sensors and, in rounds by backward,
 * their batches. */
struct chunk_header {
    struct orl_health health;
};

static size_t batches_of(const struct orl_rendering *rendering)
{
    return rendering->state->sensor_round ? ORL_MAP_BATCHES : 0;
}

static size_t chunk_bytes(const struct orl_rendering *rendering, size_t count)
{
    return sizeof(struct chunk_header) +
           count * (sizeof(struct orl_sensor_estimate) + batches_of(rendering) * sizeof(double));
}

static int make_chunk(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                      struct orl_error *err)
{
    struct orl_rendering *rendering = ctx;
    const struct orl_run_state *state = rendering->state;
    const size_t first = index * rendering->chunk, count = orl_sensor_chunk_size(rendering, first);
    struct chunk_header header;
    struct orl_health before;
    char *to = malloc(chunk_bytes(rendering, count));
    *ret_data = to;
    *ret_size = chunk_bytes(rendering, count);
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", count);
    orl_run_move_health(state, &before);
    const int code = orl_rendering_compute_chunk(rendering, first, err);
    orl_run_move_health(state, &header.health);
    orl_health_add(&before, &header.health);
    state->searches[0].health = before;
    memcpy(to, &header, sizeof header);
    to += sizeof header;
    memcpy(to, rendering->found, count * sizeof *rendering->found);
    to += count * sizeof *rendering->found;
    for (size_t i = 0; i < count && batches_of(rendering) > 0; i++) {
        const size_t bytes = ORL_MAP_BATCHES * sizeof(double);
        memcpy(to,
               state->sensor_round->batches +
                   orl_rendering_sensor_at(rendering, first + i) * ORL_MAP_BATCHES,
               bytes);
        to += bytes;
    }
    return code;
}

static int load_chunk(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                      struct orl_error *err)
{
    struct orl_rendering *rendering = ctx;
    const struct orl_run_state *state = rendering->state;
    const size_t first = index * rendering->chunk, count = orl_sensor_chunk_size(rendering, first);
    const char *from = data;
    struct chunk_header header;
    (void)err;
    *ret_taken = size == chunk_bytes(rendering, count);
    if (!*ret_taken)
        return 0;
    memcpy(&header, from, sizeof header);
    from += sizeof header;
    memcpy(rendering->found, from, count * sizeof *rendering->found);
    from += count * sizeof *rendering->found;
    for (size_t i = 0; i < count; i++) {
        const size_t sensor = orl_rendering_sensor_at(rendering, first + i),
                     bytes = batches_of(rendering) * 8;
        rendering->renderer->sensor_loaded(rendering->renderer->ctx, sensor, &rendering->found[i]);
        if (bytes > 0)
            memcpy(state->sensor_round->batches + sensor * ORL_MAP_BATCHES, from, bytes);
        from += bytes;
        atomic_fetch_add(&rendering->samples_done, orl_run_sensor_samples(state, sensor));
    }
    orl_health_add(&state->result->health, &header.health);
    orl_rendering_report_sensors(rendering);
    return 0;
}

static void name_chunk(const struct orl_rendering *rendering, size_t first,
                       struct orl_job_task *job_task)
{
    const struct orl_run_state *state = rendering->state;
    const uint64_t numbers[] = {first, state->n_sensors};
    struct orl_sha256 hash;
    orl_task_key_begin(state, &hash);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    for (size_t i = 0; i < orl_sensor_chunk_size(rendering, first); i++) {
        const size_t sensor = orl_rendering_sensor_at(rendering, first + i);
        const uint64_t samples = orl_run_sensor_samples(state, sensor);
        const uint64_t before =
            state->sensor_round ? state->sensor_round->before[sensor] : UINT64_MAX;
        orl_sha256_add(&hash, &samples, sizeof samples);
        orl_sha256_add(&hash, &before, sizeof before);
        job_task->work += (double)samples;
    }
    orl_task_key_end(&hash, job_task->key);
    snprintf(job_task->kind, sizeof job_task->kind, "sensors");
}

static void report_share(void *ctx, double share)
{
    struct orl_rendering *rendering = ctx;
    const double samples_done = (double)atomic_load(&rendering->samples_done);
    rendering->total_done = samples_done + share * ((double)rendering->samples - samples_done);
    orl_rendering_report_sensors(rendering);
}

int orl_rendering_share_sensors(struct orl_rendering *rendering, struct orl_error *err)
{
    const struct orl_run_state *state = rendering->state;
    rendering->chunk = orl_task_chunk_size(state->n_sensors);
    struct orl_task_work work = {.n = (state->n_sensors + rendering->chunk - 1) / rendering->chunk,
                                 .ctx = rendering,
                                 .make = make_chunk,
                                 .take = load_chunk,
                                 .told = report_share};
    work.tasks = calloc(work.n, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < work.n; i++)
        name_chunk(rendering, i * rendering->chunk, &work.tasks[i]);
    orl_task_work_estimate(state, &work, rendering->share);
    const int code = orl_run_tasks(state->env, &work, err);
    free(work.tasks);
    return code;
}
