/* Distributes views as tasks of a job. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/estimate/stage_progress.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

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

static void report_share(void *ctx, double share)
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
                                 .told = report_share};
    work.tasks = calloc(n + 1, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < n; i++)
        name_view_task(rendering->state, views[i], &work.tasks[i]);
    orl_task_work_estimate(rendering->state, &work, 1 - rendering->share);
    const int code = orl_run_tasks(rendering->state->env, &work, err);
    free(work.tasks);
    return code;
}
