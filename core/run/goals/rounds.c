#include "run/goals/rounds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "run/diagnostics/diagnostics.h"
#include "run/distributed/task_work.h"
#include "run/estimate/progress.h"
#include "run/estimate/round_cost.h"
#include "run/goals/percentile.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

/* Factor of the smallest rounds with a deadline, for sensors and for views' photons: small rounds
 * fill the remaining time. */
static const double short_round = 0.25;
/* Maximum samples of one sensor in a round. */
static const double most_of_a_sensor = 1 << 20;

static int rounds_init(struct orl_rounds *r, struct orl_run_state *state, struct orl_error *err)
{
    *r = (struct orl_rounds){.state = state, .error = NAN};
    r->work = orl_work_of(state);
    const bool of_pixels =
        r->work.of_views && orl_technique_facts(r->work.technique)->samples_paths;
    if (state->job->goal.deadline_s > 0 && !of_pixels)
        r->work.least *= short_round;
    if (state->pilot && state->pilot->samples > 0)
        r->work.least = state->pilot->samples;
    r->samples = r->work.least;
    state->progress->rounds_unknown =
        state->job->goal.relative_error > 0 || state->job->goal.dgp_error > 0;
    if (!orl_goal_is_set(&state->job->goal)) {
        r->planned = orl_run_count_batches(state);
        r->samples = ceil((double)ORL_DEFAULT_GATHER_SAMPLES / r->planned);
    }
    memcpy(r->estimated_s, state->clock.cost_s, sizeof r->estimated_s);
    if (state->job->goal.deadline_s > 0)
        r->samples = orl_deadline_first(
            &r->work, r->estimated_s[ORL_STAGE_PHOTONS] + r->estimated_s[ORL_STAGE_MAPS],
            r->estimated_s[ORL_STAGE_RENDER],
            state->job->goal.deadline_s - (orl_rounds_now(r) - state->clock.started_s));
    r->wanted = orl_rounds_estimate_samples(r);
    orl_rounds_estimate(r);
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    const int code = orl_run_ensure_renderer(state, err); /* once a job, not in every round */
    if (code < 0)
        return code;
    r->throughput.setup_s = orl_rounds_now(r) - state->clock.started_s;
    if (r->work.by_noise) {
        const size_t n = state->n_sensors;
        double *batches = calloc(n * ORL_MAP_BATCHES + 1, sizeof *batches);
        r->shares = malloc((n + 1) * sizeof *r->shares);
        r->sample_counts = calloc(2 * n + 1, sizeof *r->sample_counts);
        r->sensor_round = (struct orl_sensor_round){state->job->seed, r->sample_counts,
                                                    r->sample_counts + n, batches};
        if (!r->shares || !r->sample_counts || !batches)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    }
    return orl_pooled_results_init(&r->results, state, r->work.by_noise, err);
}

static void rounds_done(struct orl_rounds *r)
{
    orl_pooled_results_done(&r->results);
    free(r->shares);
    free(r->sample_counts);
    free(r->sensor_round.batches);
}

static int receive_film(void *ctx, size_t index, const struct orl_film *film, struct orl_error *err)
{
    struct orl_rounds *r = ctx;
    return orl_pooled_results_add_film(&r->results, index, film, r->samples, err);
}

/* ---- A round --------------------------------------------------------------------------------- */

static bool is_known(const struct orl_result *result, const char *warning)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strcmp(result->warnings[i], warning) == 0)
            return true;
    return false;
}

/* Adds a round's warnings, view times and, in the first round, maps to the result. */
static void add_records(struct orl_rounds *r, struct orl_result *found_by)
{
    struct orl_result *result = r->state->result;
    for (size_t i = 0; i < found_by->n_warnings; i++)
        if (!is_known(result, found_by->warnings[i]))
            orl_run_warn(r->state, "%s", found_by->warnings[i]);
    for (size_t i = 0; i < found_by->n_views; i++)
        result->views[i].seconds += found_by->views[i].seconds;
    if (r->count == 0) {
        memcpy(result->maps, found_by->maps, sizeof result->maps);
        result->n_maps = found_by->n_maps;
    }
}

/* Adds a round's time and counters to the result, even if the round failed. */
static void add_spent(struct orl_rounds *r, const struct orl_result *spent)
{
    struct orl_result *result = r->state->result;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        result->timings_s[i] += spent->timings_s[i];
    orl_health_add(&result->health, &spent->health);
}

static void add_times(struct orl_rounds *r, const struct orl_result *found_by, double all_s)
{
    const double photon_s =
        found_by->timings_s[ORL_STAGE_PHOTONS] + found_by->timings_s[ORL_STAGE_MAPS];
    const double render_s = found_by->timings_s[ORL_STAGE_RENDER];
    const struct orl_plan *plan = &found_by->plan;
    r->throughput.photons += (double)(plan->photons_global + plan->photons_caustic);
    r->throughput.photon_s += photon_s;
    for (size_t i = 0; i < found_by->n_maps; i++) /* other rounds will have to make such maps */
        r->throughput.photon_s += found_by->maps[i].earlier_s;
    r->throughput.samples += r->samples;
    r->state->samples = r->throughput.samples;
    r->throughput.render_s += render_s;
    for (size_t i = 0; i < found_by->n_views; i++)
        r->throughput.views_s += found_by->views[i].seconds;
    r->throughput.other_s += fmax(all_s - photon_s - render_s, 0);
    r->throughput.rounds++;
}

/* Allocates samples to the sensors by their noise; equal numbers in the first round. */
static void allocate_samples(struct orl_rounds *r)
{
    const double least = ORL_MAP_BATCHES; /* one sample in every batch */
    const size_t n = r->state->n_sensors;
    double sum = 0;
    if (!r->shares)
        return;
    if (r->count > 0)
        orl_allocate_samples(&r->results.estimates[0], r->samples, r->shares);
    for (size_t i = 0; i < n; i++) {
        const double wanted = r->count > 0 ? r->shares[i] : r->samples;
        const double samples = least * fmax(round(wanted / least), 1);
        r->sample_counts[n + i] += r->count > 0 ? r->sample_counts[i] : 0;
        r->sample_counts[i] = (uint32_t)fmin(samples, most_of_a_sensor);
        r->shares[i] = r->sample_counts[i];
        sum += r->shares[i];
    }
    r->samples = sum / (double)n;
}

/* Returns one of `shares` shares of samples, which differ by one at most. */
static uint32_t share_of(uint32_t samples, uint32_t index, uint32_t shares)
{
    return samples / shares + (index < samples % shares);
}

/*
 * Sets the offset of view rays. Views by photon maps send rays to fixed positions in pixels. For
 * glare these are offset in every round, so that features between them are seen and their variation
 * is measured. The offsets are the additive sequence of the plastic number (Roberts 2018), whose
 * first point is no offset.
 */
static void offset_rays(const struct orl_rounds *r, double ret_shift[2])
{
    static const double step[2] = {0.7548776662466927, 0.5698402909980532};
    const bool moved = !orl_technique_facts(r->work.technique)->samples_paths &&
                       orl_job_asks_for_glare(r->state->job);
    for (int i = 0; i < 2; i++)
        ret_shift[i] = moved ? fmod(0.5 + r->count * step[i], 1) - 0.5 : 0;
}

/* Makes a round's state: the same lit scene, with a job, a plan and a result of its own. */
static void make_round(struct orl_rounds *r, struct orl_job *job, struct orl_run_env *env,
                       struct orl_result *result, struct orl_run_state *ret_round)
{
    const struct orl_run_state *state = r->state;
    *job = *state->job;
    if (r->count > 0)
        job->seed = orl_mix64(job->seed ^ orl_mix64(r->count));
    job->gather_samples = (uint32_t)r->samples;
    job->pixel_samples = orl_work_pixel_samples(r->samples);
    if (r->planned > 0) {
        const uint32_t asked = state->job->gather_samples;
        job->gather_samples = (asked ? asked : ORL_DEFAULT_GATHER_SAMPLES) / r->planned;
        job->gather_samples += job->gather_samples == 0;
        job->pixel_samples = share_of(orl_run_pixel_samples(state), r->count, r->planned);
    }
    *result = (struct orl_result){.plan = state->result->plan};
    result->plan.photons_global = orl_work_photons(&r->work, ORL_MAP_GLOBAL, r->samples);
    result->plan.photons_caustic = orl_work_photons(&r->work, ORL_MAP_CAUSTIC, r->samples);
    *env = *state->env;
    env->map_ready = r->count == 0 ? env->map_ready : NULL;
    *ret_round = *state;
    ret_round->job = job;
    ret_round->env = env;
    ret_round->result = result;
    orl_work_bandwidths(r->samples, r->throughput.samples, r->bandwidths);
    ret_round->round.bandwidths = r->bandwidths;
    ret_round->round.view_rays = orl_work_view_rays(&r->work, r->samples);
    offset_rays(r, ret_round->round.shift);
    ret_round->round.sensor_round = r->shares ? &r->sensor_round : NULL;
    ret_round->round.receive_film = receive_film;
    ret_round->round.receive_ctx = r;
    ret_round->clock.stage_started = state->env->now_s(state->env->ctx);
    for (uint32_t i = 0; i < orl_thread_pool_size(env->pool); i++)
        memset(&state->searches[i].health, 0, sizeof state->searches[i].health);
}

/* Uses a private folder store: maps of rounds after the first are of no use to other jobs and are
 * deleted after the round. */
static void use_private_store(struct orl_run_env *env, struct orl_folder_store *folder,
                              struct orl_map_store *store)
{
    snprintf(folder->folder, sizeof folder->folder, "%s", env->output_folder);
    *store = orl_map_store_in_folder(folder);
    store->release = store->abandon;
    env->store = store;
}

static int run_round(struct orl_rounds *r, struct orl_error *err)
{
    struct orl_run_state *state = r->state, round;
    struct orl_folder_store folder;
    struct orl_map_store store;
    struct orl_run_env env;
    struct orl_result result;
    struct orl_job job;
    const double started = orl_rounds_now(r);
    allocate_samples(r);
    make_round(r, &job, &env, &result, &round);
    if (r->count > 0 && env.store && !state->pilot && !orl_run_is_distributed(state))
        use_private_store(&env, &folder, &store);
    int code = orl_run_technique(&round, err);
    if (code == 0)
        orl_run_end_stage(&round);
    orl_run_release_maps(&round);
    state->emission = round.emission;
    add_spent(r, &result);
    if (code == 0) {
        orl_pooled_results_add_sensors(&r->results, &round, r->samples, r->shares,
                                       r->sensor_round.batches);
        add_records(r, &result);
        add_times(r, &result, orl_rounds_now(r) - started);
        r->count++;
    }
    state->clock.stage = ORL_STAGE_RENDER;
    state->clock.stage_started = orl_rounds_now(r);
    free(round.rays);
    orl_result_done(&result);
    return code;
}

/* Reports sensors and views as a job without rounds does. */
static int report_views(struct orl_run_state *state)
{
    const struct orl_run_env *env = state->env;
    if (state->n_sensors > 0 && env->sensors_done)
        env->sensors_done(env->ctx, state->result);
    for (size_t i = 0; i < state->job->n_views && env->view_written; i++)
        env->view_written(env->ctx, i, &state->result->views[i]);
    return 0;
}

/* Appends a point to the history of the error. */
static void append_error_history(struct orl_outcome *outcome, double seconds)
{
    if (!isfinite(outcome->achieved))
        return;
    if (outcome->n_error_history == ORL_ERROR_HISTORY) {
        outcome->n_error_history = ORL_ERROR_HISTORY / 2;
        for (size_t i = 1; i < outcome->n_error_history; i++)
            outcome->error_history[i] = outcome->error_history[2 * i];
    }
    outcome->error_history[outcome->n_error_history].seconds = seconds;
    outcome->error_history[outcome->n_error_history++].error = outcome->achieved;
}

/* Handles a round of a pilot: stores the size of the first round, and predicts the whole job from
 * it. */
static void resolve_pilot(struct orl_rounds *r, const struct orl_work *usual,
                          const struct orl_output_estimates *outputs)
{
    const struct orl_pilot *pilot = r->state->pilot;
    struct orl_throughput throughput = r->throughput;
    double views_s = 0;
    for (size_t i = 0; i < r->state->result->n_views; i++)
        views_s += r->state->result->views[i].seconds;
    /* If rendering costs the same in each round, its sensors have as many samples as the job's
     * rounds. */
    const bool alike = orl_work_view_time_is_fixed(usual);
    const double times = alike ? usual->least / r->work.least : 1;
    throughput.render_s = fmax(throughput.render_s - views_s, 0) * pilot->sensor_factor * times +
                          views_s * pilot->view_factor;
    r->ended = r->count >= ORL_PILOT_ROUNDS;
    r->samples = r->work.least;
    if (alike) /* then sensors' own noise is that of a round, for any number of photons */
        throughput.samples = r->count * usual->least;
    orl_run_predict_cost(r->state, &throughput, usual, outputs);
    orl_run_compute_curve(r->state, &throughput, usual, outputs, pilot->curve);
    orl_rounds_estimate(r);
}

/* Updates the outcome and decides what follows. */
static int resolve_round(struct orl_rounds *r, struct orl_error *err)
{
    struct orl_run_state *state = r->state;
    struct orl_result *result = state->result;
    const struct orl_output_estimates outputs = {r->results.estimates, r->results.n_outputs,
                                                 state->job->goal.at};
    const struct orl_work usual = orl_work_of(state);
    const double started = orl_rounds_now(r);
    r->ended = r->planned > 0 && r->count >= r->planned;
    if (r->planned > 0 && !r->ended) {
        orl_rounds_estimate(r);
        return 0;
    }
    orl_pooled_results_evaluate(&r->results);
    r->error = orl_output_estimates_error(&outputs);
    if (r->planned == 0) {
        result->outcome.rounds = r->count;
        result->outcome.achieved = r->error;
    }
    if (state->pilot) {
        resolve_pilot(r, &usual, &outputs);
        return 0;
    }
    orl_run_predict_cost(state, &r->throughput, &usual, &outputs);
    const int code = orl_pooled_results_write(&r->results, state, err);
    r->throughput.other_s += orl_rounds_now(r) - started;
    if (r->planned > 0)
        return code == 0 ? report_views(state) : code;
    orl_rounds_plan_next(r, &outputs);
    orl_rounds_estimate(r);
    state->progress->rounds_unknown = false;
    result->total_s = orl_rounds_now(r) - state->clock.started_s;
    append_error_history(&result->outcome, result->total_s);
    if (code == 0 && state->env->round_ready)
        state->env->round_ready(state->env->ctx, result);
    return code;
}

static void report_final_views(struct orl_rounds *r)
{
    const struct orl_run_env *env = r->state->env;
    for (size_t i = 0; i < r->state->job->n_views && env->view_ready; i++) {
        const struct orl_film *film = &r->results.outputs[r->results.first_view + i].film;
        env->view_ready(env->ctx, i, film->pixels, orl_film_has_errors(film) ? film->errors : NULL,
                        (size_t)film->width * film->height);
    }
}

int orl_run_rounds(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_rounds r;
    int code = rounds_init(&r, state, err);
    state->result->outcome =
        (struct orl_outcome){.asked = r.planned == 0, .goal = state->job->goal, .achieved = NAN};
    while (code == 0 && !r.ended) {
        orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
        code = run_round(&r, err);
        if (code == 0)
            code = resolve_round(&r, err);
    }
    if (code == 0)
        report_final_views(&r);
    rounds_done(&r);
    return code;
}
