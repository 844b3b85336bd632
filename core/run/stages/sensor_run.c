#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the estimated seconds of the stages from photons on. */
static double estimated_s(const struct orl_run_state *state)
{
    return state->clock.cost_s[ORL_STAGE_PHOTONS] + state->clock.cost_s[ORL_STAGE_MAPS] +
           state->clock.cost_s[ORL_STAGE_RENDER];
}

static struct orl_job without_views(const struct orl_job *job)
{
    struct orl_job sensors = *job;
    sensors.views = NULL;
    sensors.n_views = 0;
    sensors.goal.dgp_error = 0;
    return sensors;
}

static struct orl_job without_sensors(const struct orl_job *job)
{
    struct orl_job views = *job;
    views.sensors_file = NULL;
    views.sensors = NULL;
    views.n_sensors = 0;
    views.grids = NULL;
    views.n_grids = 0;
    return views;
}

/* Makes the state continue with the views. */
static void switch_to_views(struct orl_run_state *state, struct orl_sensor_run *run)
{
    run->is_separate = true;
    run->job = state->job;
    run->all = state->env;
    run->n_sensors = state->n_sensors;
    run->views = without_sensors(state->job);
    state->job = &run->views;
    state->n_sensors = 0;
    orl_run_estimate_stages(state);
}

/* Divides the run's progress between sensors and views. */
static struct orl_run_env divide_progress(struct orl_run_state *state, struct orl_sensor_run *run,
                                          double sensors_s)
{
    const struct orl_run_env *whole = state->env;
    const double part = whole->part > 0 ? whole->part : 1, done = state->progress->share;
    const double views_s = estimated_s(state);
    const double share = sensors_s > 0 ? sensors_s / (sensors_s + views_s) : 0.5;
    struct orl_run_env sensors = *whole;
    sensors.part_from = whole->part_from + part * done;
    sensors.part = part * (1 - done) * share;
    sensors.part_after_s = views_s + whole->part_after_s;
    sensors.part_stages_s = NULL;
    sensors.plan_ready = NULL;
    sensors.round_ready = NULL;
    sensors.spent = NULL;
    run->env = *whole;
    run->env.part_from = whole->part_from + part * share;
    run->env.part = part * (1 - share);
    return sensors;
}

static void move_values(struct orl_result *to, struct orl_result *from)
{
    to->illuminance_lx = from->illuminance_lx;
    to->standard_error_lx = from->standard_error_lx;
    to->bias_estimate_lx = from->bias_estimate_lx;
    to->interval_95_lx = from->interval_95_lx;
    to->doubts = from->doubts;
    to->n_sensors = from->n_sensors;
    to->cross_check = from->cross_check;
    from->illuminance_lx = from->standard_error_lx = from->bias_estimate_lx = NULL;
    from->interval_95_lx = NULL;
    from->doubts = NULL;
    from->n_sensors = 0;
}

int orl_sensor_run_start(struct orl_run_state *state, struct orl_sensor_run *ret_run,
                         struct orl_error *err)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_run_env *env = state->env;
    struct orl_sensor_run *run = ret_run;
    if (plan->sensor_technique == plan->technique || state->pilot)
        return 0;
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    const double started = env->now_s(env->ctx), all_s = estimated_s(state);
    switch_to_views(state, run);
    const struct orl_run_env sensors_env = divide_progress(state, run, all_s - estimated_s(state));
    const struct orl_job sensors = without_views(run->job);
    const int code = state->run_sensors(&sensors, &sensors_env, state->scene, &run->result, err);
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    if (code < 0)
        return code;
    move_values(state->result, &run->result);
    state->result->plan.sensor_technique = run->result.plan.sensor_technique;
    memcpy(state->result->plan.sensor_why, run->result.plan.sensor_why, ORL_WHY_MAX);
    state->env = &run->env;
    run->seconds = env->now_s(env->ctx) - started;
    state->clock.stage_started += run->seconds;
    state->clock.started_s += run->seconds;
    state->progress->at_s += run->seconds;
    return 0;
}

/* ---- Joining the results --------------------------------------------------------------------- */

/* Adds the sensors' counts, except those of the scene's files, which both runs have counted. */
static void join_health(struct orl_health *sum, const struct orl_health *sensors)
{
    struct orl_health part = *sensors;
    part.bsdf_clamped = part.bsdf_rescaled = part.bsdf_values = 0;
    part.degenerate = part.surfaces = part.instances = 0;
    orl_health_add(sum, &part);
}

/* Joins the outcomes: the accuracy is met if sensors and views meet it; the error is the larger
 * one. */
static void join_outcomes(const struct orl_sensor_run *run, struct orl_outcome *outcome)
{
    const struct orl_outcome *sensors = &run->result.outcome;
    for (uint32_t i = 0; i < outcome->n_error_history; i++)
        outcome->error_history[i].seconds += run->seconds;
    if (!sensors->asked)
        return;
    if (!sensors->met) {
        outcome->met = false;
        snprintf(outcome->why, sizeof outcome->why, "sensors: %.200s", sensors->why);
    }
    outcome->rounds = sensors->rounds > outcome->rounds ? sensors->rounds : outcome->rounds;
    if (isnan(sensors->achieved) || sensors->achieved > outcome->achieved)
        outcome->achieved = sensors->achieved;
}

/* Joins the costs: times are for both errors to be halved, or to fall to one per cent. */
static void join_costs(struct orl_cost *cost, const struct orl_cost *sensors)
{
    const bool worse = isnan(sensors->error) || sensors->error > cost->error;
    cost->rays += sensors->rays;
    cost->photons += sensors->photons;
    cost->halve_s += sensors->halve_s;
    cost->one_percent_s += sensors->one_percent_s;
    if (!worse)
        return;
    cost->error = sensors->error;
    snprintf(cost->model, sizeof cost->model, "%s", sensors->model);
}

static void join_maps(struct orl_result *result, const struct orl_result *sensors)
{
    for (size_t i = 0; i < sensors->n_maps && result->n_maps < ORL_RESULT_MAPS; i++)
        result->maps[result->n_maps++] = sensors->maps[i];
}

void orl_sensor_run_join(struct orl_run_state *state, struct orl_sensor_run *run)
{
    struct orl_result *result = state->result;
    const struct orl_result *sensors = &run->result;
    if (!run->is_separate)
        return;
    state->job = run->job;
    state->env = run->all;
    state->n_sensors = run->n_sensors;
    state->clock.started_s -= run->seconds;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        result->timings_s[i] += sensors->timings_s[i];
    for (size_t i = 0; i < sensors->n_warnings; i++)
        orl_run_warn_once(state, "%s", sensors->warnings[i]);
    join_health(&result->health, &sensors->health);
    join_outcomes(run, &result->outcome);
    join_costs(&result->cost, &sensors->cost);
    join_maps(result, sensors);
    orl_result_done(&run->result);
}

/* ---- Second run after the cross-check -------------------------------------------------------- */

static size_t count_doubts(const struct orl_result *result)
{
    size_t n = 0;
    for (size_t i = 0; result->doubts && i < result->n_sensors; i++)
        n += result->doubts[i] != 0;
    return n;
}

/* Returns true if a second run is allowed. A deadline leaves no time for one. If views have an
 * accuracy to meet, the outcome belongs to both, and a second run is not allowed either. */
static bool may_run_again(const struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    return job->technique == ORL_TECHNIQUE_AUTO &&
           job->overrides[ORL_EFFECT_FINAL_GATHER] == ORL_OVERRIDE_AUTO && !state->pilot &&
           state->result->cross_check.sensors_off > 0 && !(job->goal.deadline_s > 0) &&
           !(job->n_views > 0 && orl_goal_is_set(&job->goal)) && !state->lit_scene->scene->mist;
}

static struct orl_run_env env_of_second(const struct orl_run_state *state)
{
    struct orl_run_env env = *state->env;
    const double part = env.part > 0 ? env.part : 1, done = state->progress->share;
    env.part_from += part * done;
    env.part = part * (1 - done);
    env.part_stages_s = NULL;
    env.plan_ready = NULL;
    env.round_ready = NULL;
    env.sensors_kept = NULL;
    env.sensors_done = NULL;
    env.spent = NULL;
    return env;
}

static void free_values(struct orl_result *result)
{
    free(result->illuminance_lx);
    free(result->standard_error_lx);
    free(result->bias_estimate_lx);
    free(result->interval_95_lx);
    free(result->doubts);
}

static void drop_warnings(struct orl_result *result, size_t first)
{
    while (result->n_warnings > first)
        free(result->warnings[--result->n_warnings]);
}

/* Replaces values and warnings by those of the second run. */
static void adopt_second_run(struct orl_run_state *state, struct orl_result *second,
                             size_t first_warning)
{
    struct orl_result *result = state->result;
    const size_t off = result->cross_check.sensors_off, n = result->n_sensors;
    const enum orl_technique before = result->plan.sensor_technique;
    free_values(result);
    drop_warnings(result, first_warning);
    move_values(result, second);
    for (size_t i = 0; i < second->n_warnings; i++)
        orl_run_warn_once(state, "%s", second->warnings[i]);
    if (state->job->n_views == 0)
        result->outcome = second->outcome;
    result->plan.sensor_technique = second->plan.technique;
    snprintf(result->plan.sensor_why, sizeof result->plan.sensor_why,
             "with %s, %zu of %zu sensors differed from plain path tracing; with %s, %zu differ",
             orl_technique_name(before), off, n, orl_technique_name(second->plan.technique),
             result->cross_check.sensors_off);
}

int orl_sensor_run_retry(struct orl_run_state *state, size_t first_warning, struct orl_error *err)
{
    struct orl_result *result = state->result, second = {0};
    if (!may_run_again(state))
        return 0;
    struct orl_job job = without_views(state->job);
    job.technique = orl_technique_facts(result->plan.sensor_technique)->alternative;
    const struct orl_run_env *own = state->env, env = env_of_second(state);
    orl_run_end_stage(state);
    const int code = state->run_sensors(&job, &env, state->scene, &second, err);
    orl_thread_pool_set_cancel(own->pool, own->cancel);
    if (code < 0)
        return code;
    state->clock.stage_started = state->progress->at_s = own->now_s(own->ctx);
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        result->timings_s[i] += second.timings_s[i];
    join_health(&result->health, &second.health);
    if (count_doubts(&second) < count_doubts(result))
        adopt_second_run(state, &second, first_warning);
    orl_result_done(&second);
    return 0;
}
