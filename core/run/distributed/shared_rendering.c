/* Distributes chunks of sensors, and views, as tasks of a job. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

/* Distributes chunks of sensors as tasks of a job. */

/* Layout of a chunk's file: this header, the results of the sensors and, in rounds by backward,
 * their batches. */
struct chunk_header {
    struct orl_health health;
};

static size_t batches_of(const struct orl_rendering *rendering)
{
    return rendering->state->round.sensor_round ? ORL_MAP_BATCHES : 0;
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
               state->round.sensor_round->batches +
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
        orl_rendering_load_sensor(rendering, sensor, &rendering->found[i]);
        if (bytes > 0)
            memcpy(state->round.sensor_round->batches + sensor * ORL_MAP_BATCHES, from, bytes);
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
            state->round.sensor_round ? state->round.sensor_round->before[sensor] : UINT64_MAX;
        orl_sha256_add(&hash, &samples, sizeof samples);
        orl_sha256_add(&hash, &before, sizeof before);
        job_task->work += (double)samples;
    }
    orl_task_key_end(&hash, job_task->key);
    snprintf(job_task->kind, sizeof job_task->kind, "sensors");
}

static void report_sensors_share(void *ctx, double share)
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
                                 .told = report_sensors_share};
    work.tasks = calloc(work.n, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a job");
    for (size_t i = 0; i < work.n; i++)
        name_chunk(rendering, i * rendering->chunk, &work.tasks[i]);
    orl_task_work_estimate(state, &work, rendering->share);
    const int code = orl_run_tasks(state->env, &work, err);
    free(work.tasks);
    return code;
}

/* Distributes views as tasks of a job. */

/* Context of the task callbacks. */
struct view_tasks {
    struct orl_rendering *rendering;
    const size_t *views;
};

/* Layout of a picture's file: this header, pixels, and their errors. */
struct picture_header {
    struct orl_health health;
    double seconds;
};

static size_t pixels_of(const struct orl_film *film)
{
    return (size_t)film->width * film->height;
}

static size_t bytes_of(const struct orl_film *film)
{
    return sizeof(struct picture_header) +
           pixels_of(film) * (sizeof *film->pixels + sizeof *film->errors);
}

static int pack_view(const struct orl_film *film, const struct picture_header *picture_header,
                     void **ret_data, size_t *ret_size, struct orl_error *err)
{
    const size_t pixels = pixels_of(film) * sizeof *film->pixels;
    char *to = malloc(bytes_of(film));
    *ret_data = to;
    *ret_size = bytes_of(film);
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    memcpy(to, picture_header, sizeof *picture_header);
    memcpy(to + sizeof *picture_header, film->pixels, pixels);
    memcpy(to + sizeof *picture_header + pixels, film->errors,
           pixels_of(film) * sizeof *film->errors);
    return 0;
}

static int make_view_task(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                          struct orl_error *err)
{
    const struct view_tasks *view_tasks = ctx;
    const struct orl_run_state *state = view_tasks->rendering->state;
    const struct orl_run_env *env = state->env;
    const size_t view = view_tasks->views[index];
    const double started = env->now_s(env->ctx);
    struct orl_health before;
    struct picture_header picture_header;
    struct orl_film film = {0};
    memset(&picture_header, 0, sizeof picture_header);
    orl_run_move_health(state, &before);
    int code = orl_rendering_paint_view(view_tasks->rendering, view, &film, err);
    orl_run_move_health(state, &picture_header.health);
    orl_health_add(&before, &picture_header.health);
    state->searches[0].health = before;
    picture_header.seconds = env->now_s(env->ctx) - started;
    if (code == 0)
        code = pack_view(&film, &picture_header, ret_data, ret_size, err);
    if (code == 0)
        code = orl_rendering_finish_view(view_tasks->rendering, view, &film, started, err);
    orl_film_done(&film);
    return code;
}

static int load_view(const struct view_tasks *view_tasks, size_t view, const char *data,
                     size_t size, bool *ret_fits, struct orl_error *err)
{
    struct orl_run_state *state = view_tasks->rendering->state;
    struct orl_view ignored;
    struct orl_film film = {0};
    struct picture_header picture_header;
    int code = orl_rendering_open_view(state, view, &ignored, &film, err);
    *ret_fits = code == 0 && size == bytes_of(&film);
    if (*ret_fits) {
        const size_t pixels = pixels_of(&film) * sizeof *film.pixels;
        memcpy(&picture_header, data, sizeof picture_header);
        memcpy(film.pixels, data + sizeof picture_header, pixels);
        memcpy(film.errors, data + sizeof picture_header + pixels,
               pixels_of(&film) * sizeof *film.errors);
        orl_health_add(&state->result->health, &picture_header.health);
        code = orl_rendering_finish_view(
            view_tasks->rendering, view, &film,
            state->env->now_s(state->env->ctx) - picture_header.seconds, err);
    }
    orl_film_done(&film);
    return code;
}

static int load_view_task(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                          struct orl_error *err)
{
    const struct view_tasks *view_tasks = ctx;
    return load_view(view_tasks, view_tasks->views[index], data, size, ret_taken, err);
}

static void name_view_task(const struct orl_run_state *state, size_t index,
                           struct orl_job_task *job_task)
{
    const struct orl_view_request *view = &state->job->views[index];
    const uint64_t numbers[] = {index, state->job->pixel_samples, view->width, view->height};
    struct orl_sha256 hash;
    orl_task_key_begin(state, &hash);
    orl_sha256_add(&hash, numbers, sizeof numbers);
    orl_sha256_add(&hash, view->view, strlen(view->view));
    orl_task_key_end(&hash, job_task->key);
    snprintf(job_task->kind, sizeof job_task->kind, "view");
    job_task->work = (double)view->width * view->height;
    job_task->bytes = ORL_PIXEL_BYTES * (uint64_t)view->width * view->height;
}

static void report_views_share(void *ctx, double share)
{
    const struct orl_rendering *rendering = ((const struct view_tasks *)ctx)->rendering;
    orl_run_report_progress(rendering->state, rendering->share + share * (1 - rendering->share));
}

int orl_rendering_share_views(struct orl_rendering *rendering, const size_t *views, size_t n,
                              struct orl_error *err)
{
    struct view_tasks view_tasks = {rendering, views};
    struct orl_task_work work = {.n = n,
                                 .ctx = &view_tasks,
                                 .make = make_view_task,
                                 .take = load_view_task,
                                 .told = report_views_share};
    work.tasks = calloc(n + 1, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a job");
    for (size_t i = 0; i < n; i++)
        name_view_task(rendering->state, views[i], &work.tasks[i]);
    orl_task_work_estimate(rendering->state, &work, 1 - rendering->share);
    const int code = orl_run_tasks(rendering->state->env, &work, err);
    free(work.tasks);
    return code;
}
