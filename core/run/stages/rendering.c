#include "run/stages/rendering.h"

#include <math.h>

#include "run/estimate/progress.h"
#include "run/estimate/round_cost.h"
#include "run/output/output_files.h"
#include "run/run_state.h"

/* ---- Sensors --------------------------------------------------------------------------------- */

static void report_samples(const struct orl_rendering *rendering, double samples_done)
{
    const double share = fmin(samples_done / fmax((double)rendering->samples, 1), 1);
    orl_run_report_progress(rendering->state,
                            rendering->share * orl_run_sensors_time_share(rendering->state, share));
}

void orl_rendering_report_sensors(const struct orl_rendering *rendering)
{
    report_samples(rendering,
                   fmax((double)atomic_load(&rendering->samples_done), rendering->total_done));
}

/* Reports progress when the lead thread has finished a sensor. Other threads have had the same
 * time. They have therefore done about as much, and are within one sensor of it. */
static void report_in_progress(const struct orl_rendering *rendering, double samples)
{
    const double members = orl_thread_pool_size(rendering->state->env->pool);
    const double booked = (double)atomic_load(&rendering->samples_done);
    const double alike = members * rendering->done_by_main;
    report_samples(rendering, fmin(fmax(alike, booked), booked + (members - 1) * samples));
}

/* Returns a sensor as the technique gets it; its seed and first sample are those of all rounds. */
static struct orl_sensor_query query_of(const struct orl_run_state *state, size_t index,
                                        struct orl_search *search)
{
    const struct orl_sensor *sensor = &state->sensors[index];
    const struct orl_sensor_round *round = state->round.sensor_round;
    return (struct orl_sensor_query){
        .index = index,
        .position = orl_sub(sensor->position, state->lit_scene->geometry->center),
        .normal = orl_normalize(sensor->direction),
        .samples = orl_run_sensor_samples(state, index),
        .seed = round ? round->seed : state->job->seed,
        .first = round ? round->before[index] : 0,
        .search = search};
}

static void store_batches(const struct orl_sensor_round *round, size_t index,
                          const struct orl_rgb batches[ORL_MAP_BATCHES])
{
    for (uint32_t batch = 0; batch < ORL_MAP_BATCHES; batch++)
        round->batches[index * ORL_MAP_BATCHES + batch] =
            ORL_EFFICACY_LM_PER_W * orl_luma(batches[batch]);
}

static void compute_sensor(void *arg, size_t index, uint32_t member)
{
    struct orl_rendering *rendering = arg;
    const struct orl_run_state *state = rendering->state;
    const struct orl_renderer *renderer = &state->renderer;
    struct orl_sensor_estimate *found = &rendering->found[index];
    struct orl_rgb batches[ORL_MAP_BATCHES];
    if (atomic_load_explicit(state->env->cancel, memory_order_relaxed))
        return;
    const size_t sensor = orl_rendering_sensor_at(rendering, rendering->first + index);
    const struct orl_sensor_query query = query_of(state, sensor, &state->searches[member]);
    renderer->methods->compute_sensor(renderer->technique, &query, found, batches);
    orl_run_store_sensor(state, sensor, &found->estimate);
    if (state->round.sensor_round)
        store_batches(state->round.sensor_round, sensor, batches);
    const double samples = orl_run_sensor_samples(state, sensor);
    atomic_fetch_add(&rendering->samples_done, (uint64_t)samples);
    if (member == 0) { /* only the lead thread reports progress */
        rendering->done_by_main += samples;
        report_in_progress(rendering, samples);
    }
}

uint32_t orl_run_sensor_samples(const struct orl_run_state *state, size_t index)
{
    const uint32_t all = state->job->gather_samples;
    if (state->round.sensor_round)
        return state->round.sensor_round->samples[index];
    return all ? all : ORL_DEFAULT_GATHER_SAMPLES;
}

void orl_run_store_sensor(const struct orl_run_state *state, size_t index,
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
    state->rays[index] =
        orl_ray_moments_mix(estimate->rays, lux, (struct orl_ray_moments){0, 0}, 0);
}

void orl_rendering_load_sensor(struct orl_rendering *rendering, size_t sensor,
                               const struct orl_sensor_estimate *found)
{
    const struct orl_run_state *state = rendering->state;
    const struct orl_renderer *renderer = &state->renderer;
    const struct orl_sensor_query query = query_of(state, sensor, NULL);
    if (renderer->methods->load_sensor)
        renderer->methods->load_sensor(renderer->technique, &query, found);
    orl_run_store_sensor(state, sensor, &found->estimate);
}

int orl_rendering_compute_chunk(struct orl_rendering *rendering, size_t first,
                                struct orl_error *err)
{
    const struct orl_run_env *env = rendering->state->env;
    rendering->first = first;
    orl_parallel_for(env->pool, orl_sensor_chunk_size(rendering, first), compute_sensor, rendering);
    if (atomic_load(env->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while computing sensors");
    orl_rendering_report_sensors(rendering);
    return 0;
}

/* ---- Views ----------------------------------------------------------------------------------- */

static void view_progress(void *ctx, double fraction)
{
    const struct orl_view_progress *progress = ctx;
    orl_run_report_progress(progress->state, progress->before + progress->share * fraction);
}

static void view_phase(void *ctx, double from, double to)
{
    const struct orl_view_progress *progress = ctx;
    orl_run_begin_phase(progress->state, progress->before + progress->share * from,
                        progress->before + progress->share * to);
}

/* Hands a finished picture to receive_film, or writes it and reports it. */
static int store_film(struct orl_run_state *state, size_t index, const struct orl_film *film,
                      struct orl_error *err)
{
    if (state->round.receive_film)
        return state->round.receive_film(state->round.receive_ctx, index, film, err);
    orl_run_store_pixels(state, index, film);
    if (state->env->view_ready)
        state->env->view_ready(state->env->ctx, index, film->pixels,
                               orl_film_has_errors(film) ? film->errors : NULL,
                               (size_t)film->width * film->height);
    const int code = orl_run_write_view(state, index, film, err);
    if (code == 0 && state->env->view_written)
        state->env->view_written(state->env->ctx, index, &state->result->views[index]);
    return code;
}

int orl_rendering_open_view(struct orl_run_state *state, size_t index, struct orl_view *ret_view,
                            struct orl_film *ret_film, struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    if (state->result->n_views <= index)
        state->result->n_views = index + 1;
    int code = orl_view_parse(request->view, ret_view, err);
    return code == 0 ? orl_film_init(ret_film, request->width, request->height, err) : code;
}

int orl_rendering_paint_view(struct orl_rendering *rendering, size_t index,
                             struct orl_film *ret_film, struct orl_error *err)
{
    struct orl_run_state *state = rendering->state;
    const struct orl_paint_env env = {.pool = state->env->pool,
                                      .searches = state->searches,
                                      .cancel = state->env->cancel,
                                      .index = index,
                                      .progress = view_progress,
                                      .phase = view_phase,
                                      .ctx = &rendering->views[index]};
    struct orl_view view;
    const struct orl_painting painting = {.env = &env,
                                          .geometry = state->lit_scene->geometry,
                                          .view = &view,
                                          .film = ret_film,
                                          .irradiance = state->job->views[index].irradiance,
                                          .shift = {state->round.shift[0], state->round.shift[1]},
                                          .rays = state->round.view_rays};
    const int code = orl_rendering_open_view(state, index, &view, ret_film, err);
    return code == 0
               ? state->renderer.methods->paint_view(state->renderer.technique, &painting, err)
               : code;
}

int orl_rendering_finish_view(struct orl_rendering *rendering, size_t index,
                              const struct orl_film *film, double started_s, struct orl_error *err)
{
    struct orl_run_state *state = rendering->state;
    const int code = store_film(state, index, film, err);
    state->result->views[index].seconds = state->env->now_s(state->env->ctx) - started_s;
    return code;
}
