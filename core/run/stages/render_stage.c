#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture/false_color.h"
#include "run/estimate/progress.h"
#include "run/estimate/round_cost.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

void orl_run_add_sparse_errors(struct orl_result *result, const struct orl_sensor *sensors,
                               const struct orl_ray_moments *rays)
{
    struct orl_sparse_events sparse[ORL_SENSOR_ORIENTATIONS];
    orl_sparse_events_of(&(struct orl_sparse_event_sensors){sensors, rays, result->illuminance_lx,
                                                            result->standard_error_lx,
                                                            result->n_sensors},
                         sparse);
    for (size_t i = 0; i < result->n_sensors; i++) {
        const double value = result->illuminance_lx[i];
        const struct orl_sparse_events *of_side =
            &sparse[orl_sensor_orientation(sensors[i].direction)];
        const struct orl_sparse_event_bounds least =
            orl_sparse_event_bounds(of_side, &rays[i], value);
        double *error = &result->standard_error_lx[i], *interval = result->interval_95_lx[i];
        *error = fmax(*error, least.standard_error);
        interval[0] = fmax(fmin(interval[0], value - least.below), 0);
        interval[1] = fmax(interval[1], value + least.above);
    }
}

static int compute_chunks(struct orl_rendering *rendering, struct orl_error *err)
{
    int code = 0;
    if (orl_run_is_distributed(rendering->state))
        return orl_rendering_share_sensors(rendering, err);
    for (size_t first = 0; first < rendering->state->n_sensors && code == 0;
         first += rendering->chunk)
        code = orl_rendering_compute_chunk(rendering, first, err);
    return code;
}

/* Adds the light that the technique estimates for all sensors together, by photons. */
static int finish_sensors(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_renderer *renderer = &state->renderer;
    if (!renderer->methods->finish_sensors)
        return 0;
    const double started = state->env->now_s(state->env->ctx);
    const int code = renderer->methods->finish_sensors(renderer->technique, err);
    orl_run_move_time(state, ORL_STAGE_PHOTONS, state->env->now_s(state->env->ctx) - started);
    return code;
}

static int render_sensors(struct orl_rendering *rendering, struct orl_error *err)
{
    struct orl_run_state *state = rendering->state;
    struct orl_result *result = state->result;
    const size_t n = state->n_sensors;
    if (n == 0)
        return 0;
    result->illuminance_lx = calloc(n, sizeof(double));
    result->standard_error_lx = calloc(n, sizeof(double));
    result->bias_estimate_lx = calloc(n, sizeof(double));
    result->interval_95_lx = calloc(n, sizeof *result->interval_95_lx);
    state->rays = calloc(n, sizeof *state->rays);
    if (!result->illuminance_lx || !result->standard_error_lx || !result->bias_estimate_lx ||
        !result->interval_95_lx || !state->rays)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    result->n_sensors = n;
    for (size_t i = 0; i < n; i++)
        rendering->samples += orl_run_sensor_samples(state, i);
    if (!state->round.receive_film && state->env->sensors_kept &&
        state->env->sensors_kept(state->env->ctx, result)) {
        orl_run_report_progress(state, rendering->share);
        return 0;
    }
    rendering->stride = orl_golden_stride(n);
    orl_run_begin_phase(state, 0, rendering->share);
    int code = compute_chunks(rendering, err);
    if (code == 0)
        code = finish_sensors(state, err);
    if (code == 0 && !state->round.receive_film)
        orl_run_add_sparse_errors(result, state->sensors, state->rays);
    if (code == 0 && !state->round.receive_film && state->env->sensors_done)
        state->env->sensors_done(state->env->ctx, result);
    return code;
}

static int render_view(struct orl_rendering *rendering, size_t index, struct orl_error *err)
{
    const struct orl_run_env *env = rendering->state->env;
    const double started = env->now_s(env->ctx);
    struct orl_film film = {0};
    int code = orl_rendering_paint_view(rendering, index, &film, err);
    if (code == 0)
        code = orl_rendering_finish_view(rendering, index, &film, started, err);
    orl_film_done(&film);
    return code;
}

/* Returns true if an earlier run has left the view. */
static bool is_restored(const struct orl_run_state *state, size_t index)
{
    const struct orl_run_env *env = state->env;
    if (state->round.receive_film || !env->view_kept ||
        !env->view_kept(env->ctx, index, &state->result->views[index]))
        return false;
    state->result->n_views = index + 1;
    return true;
}

static double pixels_of(const struct orl_view_request *view)
{
    return (double)view->width * view->height;
}

/* Sets the progress of the stage before each view, and each view's share of it. */
static void set_view_shares(struct orl_rendering *rendering, double before)
{
    const struct orl_run_state *state = rendering->state;
    const struct orl_job *job = state->job;
    double all = 0;
    for (size_t i = 0; i < job->n_views; i++)
        all += pixels_of(&job->views[i]);
    for (size_t i = 0; i < job->n_views; i++) {
        const struct orl_view_request *view = &job->views[i];
        const double share = (1 - rendering->share) * pixels_of(view) / fmax(all, 1);
        rendering->views[i] =
            (struct orl_view_progress){state, before, share * orl_run_painting_share(state, view)};
        before += share;
    }
}

/* Renders the views that no earlier run has left; views: scratch for all indices. */
static int render_remaining(struct orl_rendering *rendering, size_t *views, struct orl_error *err)
{
    const struct orl_run_state *state = rendering->state;
    size_t left = 0;
    int code = 0;
    set_view_shares(rendering, rendering->share);
    for (size_t i = 0; i < state->job->n_views; i++)
        if (!is_restored(state, i))
            views[left++] = i;
    if (orl_run_is_distributed(state))
        return orl_rendering_share_views(rendering, views, left, err);
    for (size_t i = 0; i < left && code == 0; i++)
        code = render_view(rendering, views[i], err);
    return code;
}

static int render_views(struct orl_rendering *rendering, struct orl_error *err)
{
    struct orl_result *result = rendering->state->result;
    const size_t n = rendering->state->job->n_views;
    if (n == 0)
        return 0;
    size_t *views = calloc(n, sizeof *views);
    result->views = calloc(n, sizeof *result->views);
    rendering->views = calloc(n, sizeof *rendering->views);
    const int code = result->views && rendering->views && views
                         ? render_remaining(rendering, views, err)
                         : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    free(rendering->views);
    free(views);
    return code;
}

int orl_run_render(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_rendering rendering = {
        .state = state, .share = orl_run_sensors_share(state), .chunk = ORL_SENSOR_CHUNK};
    orl_run_begin_stage(state, ORL_STAGE_RENDER);
    int code = render_sensors(&rendering, err);
    if (code == 0)
        code = render_views(&rendering, err);
    for (uint32_t i = 0; i < orl_thread_pool_size(state->env->pool); i++)
        orl_health_add(&state->result->health, &state->searches[i].health);
    return code;
}
