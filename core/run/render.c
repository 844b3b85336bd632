#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/scatter.h"
#include "render/picture/error_map.h"
#include "run/cost.h"

/* What is rendered at the moment: its technique and how much of the stage came before. */
struct rendering {
    struct orl_run_state *state;
    const struct orl_renderer *renderer;
    size_t first;  /* sensor of this round */
    double share;  /* of the stage: the sensors' */
    size_t stride; /* of their order */
    uint64_t samples;
    atomic_uint_fast64_t taken; /* of the sensors' samples */
};

static void tell_sensors(const struct rendering *rendering)
{
    const double taken = (double)atomic_load(&rendering->taken);
    const double share = taken / fmax((double)rendering->samples, 1);
    orl_run_progress(rendering->state,
                     rendering->share * orl_run_sensors_time(rendering->state, share));
}

static void compute_sensor(void *arg, size_t index, uint32_t member)
{
    struct rendering *rendering = arg;
    const struct orl_run_state *state = rendering->state;
    if (atomic_load_explicit(state->env->cancel, memory_order_relaxed))
        return;
    const size_t sensor =
        orl_scatter(rendering->first + index, rendering->stride, state->n_sensors);
    rendering->renderer->sensor(rendering->renderer->ctx, sensor, member);
    atomic_fetch_add(&rendering->taken, orl_run_sensor_samples(state, sensor));
    if (member == 0) /* the lead, which alone tells */
        tell_sensors(rendering);
}

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index)
{
    const uint32_t all = state->job->gather_samples;
    if (state->sensor_round)
        return state->sensor_round->samples[index];
    return all ? all : ORL_DEFAULT_GATHER_SAMPLES;
}

void orl_run_book_sensor(const struct orl_run_state *state, size_t index,
                         const struct orl_estimate *estimate)
{
    static const double lux = ORL_EFFICACY_LM_PER_W;
    struct orl_result *result = state->result;
    const double value = lux * orl_luma(estimate->value);
    const struct orl_margins margins = orl_estimate_margins(estimate);
    result->illuminance_lx[index] = value;
    result->standard_error_lx[index] = lux * estimate->standard_error;
    result->bias_estimate_lx[index] = lux * estimate->bias;
    result->interval_95_lx[index][0] = fmax(value - lux * margins.below, 0);
    result->interval_95_lx[index][1] = value + lux * margins.above;
    state->rays[index] = orl_rays_mix(estimate->rays, lux, (struct orl_rays){0, 0}, 0);
}

void orl_run_mind_rare_light(struct orl_result *result, const struct orl_sensor *sensors,
                             const struct orl_rays *rays)
{
    struct orl_rare rare[ORL_RARE_SIDES];
    orl_rare_of(&(struct orl_rare_sensors){sensors, rays, result->illuminance_lx,
                                           result->standard_error_lx, result->n_sensors},
                rare);
    for (size_t i = 0; i < result->n_sensors; i++) {
        const double value = result->illuminance_lx[i];
        const struct orl_rare *of_side = &rare[orl_rare_side(sensors[i].direction)];
        const struct orl_rare_bounds least = orl_rare_bounds(of_side, &rays[i], value);
        double *error = &result->standard_error_lx[i], *interval = result->interval_95_lx[i];
        *error = fmax(*error, least.standard_error);
        interval[0] = fmax(fmin(interval[0], value - least.below), 0);
        interval[1] = fmax(interval[1], value + least.above);
    }
}

/* Rounds of some sensors, so that cancelling is heard in between. */
static int render_sensors(struct rendering *rendering, struct orl_error *err)
{
    enum { ROUND = 128 };
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
    if (!state->take_film && state->env->sensors_kept &&
        state->env->sensors_kept(state->env->ctx, result)) {
        orl_run_progress(state, rendering->share);
        return 0;
    }
    rendering->stride = orl_scatter_stride(n);
    orl_run_phase(state, 0, rendering->share);
    for (rendering->first = 0; rendering->first < n; rendering->first += ROUND) {
        const size_t left = n - rendering->first, count = left < ROUND ? left : ROUND;
        orl_crew_for(state->env->crew, count, compute_sensor, rendering);
        if (atomic_load(state->env->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while computing sensors");
        tell_sensors(rendering);
    }
    const struct orl_renderer *renderer = rendering->renderer;
    const int code = renderer->sensors ? renderer->sensors(renderer->ctx, err) : 0;
    if (code == 0 && !state->take_film)
        orl_run_mind_rare_light(result, state->sensors, state->rays);
    if (code == 0 && !state->take_film && state->env->sensors_done)
        state->env->sensors_done(state->env->ctx, result);
    return code;
}

/* Where one view stands among all that is rendered. */
struct view_progress {
    const struct orl_run_state *state;
    double before, share; /* of the stage; until it is painted */
};

static void view_progress(void *ctx, double fraction)
{
    const struct view_progress *progress = ctx;
    orl_run_progress(progress->state, progress->before + progress->share * fraction);
}

static void view_phase(void *ctx, double from, double to)
{
    const struct view_progress *progress = ctx;
    orl_run_phase(progress->state, progress->before + progress->share * from,
                  progress->before + progress->share * to);
}

/* Where a picture goes when it is finished. */
static int keep_film(struct orl_run_state *state, size_t index, const struct orl_film *film,
                     struct orl_error *err)
{
    if (state->take_film)
        return state->take_film(state->take_ctx, index, film, err);
    orl_run_note_pixels(state, index, film);
    if (state->env->view_ready)
        state->env->view_ready(state->env->ctx, index, film->pixels,
                               orl_film_knows_errors(film) ? film->errors : NULL,
                               (size_t)film->width * film->height);
    return orl_run_write_view(state, index, film, err);
}

static int render_view(struct rendering *rendering, size_t index, struct view_progress *progress,
                       struct orl_error *err)
{
    struct orl_run_state *state = rendering->state;
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view_result *result = &state->result->views[index];
    const struct orl_paint_env env = {.crew = state->env->crew,
                                      .searches = state->searches,
                                      .cancel = state->env->cancel,
                                      .index = index,
                                      .progress = view_progress,
                                      .phase = view_phase,
                                      .ctx = progress};
    const double started = state->env->now_s(state->env->ctx);
    struct orl_film film = {0};
    struct orl_view view;
    const struct orl_painting painting = {.env = &env,
                                          .geometry = state->world->geometry,
                                          .view = &view,
                                          .film = &film,
                                          .irradiance = request->irradiance,
                                          .shift = {state->shift[0], state->shift[1]}};
    state->result->n_views = index + 1;
    int code = orl_view_parse(request->view, &view, err);
    if (code == 0)
        orl_run_judge_view(state, request->name, &view);
    if (code == 0)
        code = orl_film_init(&film, request->width, request->height, err);
    if (code == 0)
        code = rendering->renderer->view(rendering->renderer->ctx, &painting, err);
    if (code == 0)
        code = keep_film(state, index, &film, err);
    orl_film_done(&film);
    result->seconds = state->env->now_s(state->env->ctx) - started;
    return code;
}

/* Has an earlier run left the view? */
static bool is_kept(const struct orl_run_state *state, size_t index)
{
    const struct orl_run_env *env = state->env;
    if (state->take_film || !env->view_kept ||
        !env->view_kept(env->ctx, index, &state->result->views[index]))
        return false;
    state->result->n_views = index + 1;
    return true;
}

static double pixels_of(const struct orl_view_request *view)
{
    return (double)view->width * view->height;
}

static int render_views(struct rendering *rendering, double before, struct orl_error *err)
{
    struct orl_run_state *state = rendering->state;
    const size_t n = state->job->n_views;
    double all = 0, told = before;
    int code = 0;
    if (n == 0)
        return 0;
    state->result->views = calloc(n, sizeof *state->result->views);
    if (!state->result->views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < n; i++)
        all += pixels_of(&state->job->views[i]);
    for (size_t i = 0; i < n && code == 0; i++) {
        const double share = (1 - before) * pixels_of(&state->job->views[i]) / fmax(all, 1);
        const struct orl_view_request *view = &state->job->views[i];
        struct view_progress progress = {state, told, share * orl_run_painting_share(state, view)};
        told += share;
        if (is_kept(state, i))
            continue;
        code = render_view(rendering, i, &progress, err);
        if (code == 0 && !state->take_film && state->env->view_written)
            state->env->view_written(state->env->ctx, i, &state->result->views[i]);
    }
    return code;
}

int orl_run_render(struct orl_run_state *state, const struct orl_renderer *renderer,
                   struct orl_error *err)
{
    struct rendering rendering = {
        .state = state, .renderer = renderer, .share = orl_run_sensors_share(state)};
    orl_run_enter(state, ORL_STAGE_RENDER);
    int code = render_sensors(&rendering, err);
    if (code == 0)
        code = render_views(&rendering, rendering.share, err);
    for (uint32_t i = 0; i < orl_crew_size(state->env->crew); i++)
        orl_health_add(&state->result->health, &state->searches[i].health);
    return code;
}
