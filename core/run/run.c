#include <oriel/run.h>

#include <math.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/air.h"
#include "run/ahead.h"
#include "run/cost.h"
#include "run/rounds.h"
#include "run/scene.h"

/* Rough costs, microseconds on one core: a photon traced, one indexed, a gather ray, what one reads
 * of the map for the first time, all of it at the most by photons, a pixel. */
static const double photon_us = 1.5, index_us = 0.25, gather_us = 2.5, first_us = 10, leaf_us = 0.5,
                    pixel_us = 40;

void orl_run_guess_costs(struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    const struct orl_plan *plan = &state->result->plan;
    const bool planned = plan->technique != ORL_TECHNIQUE_AUTO;
    const double photons = planned ? (double)(plan->photons_global + plan->photons_caustic)
                                   : 2.0 * ORL_DEFAULT_PHOTONS;
    const double samples = job->gather_samples ? job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    const double crew = orl_crew_size(state->env->crew), us = 1e-6 / crew;
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    state->cost_s[ORL_STAGE_LOAD] = 0.2;
    state->cost_s[ORL_STAGE_BVH] = 0.05;
    state->cost_s[ORL_STAGE_PLAN] = 0.1;
    state->cost_s[ORL_STAGE_PHOTONS] = us * photons * photon_us;
    if (plan->foresight.known)
        state->cost_s[ORL_STAGE_PHOTONS] = plan->foresight.photons_s;
    state->cost_s[ORL_STAGE_MAPS] =
        plan->technique == ORL_TECHNIQUE_BACKWARD ? 0 : us * photons * index_us;
    state->cost_s[ORL_STAGE_RENDER] =
        us * ((double)state->n_sensors * samples * gather_us + pixels * pixel_us);
    const double first_rays = (double)state->n_sensors * samples + pixels;
    if (plan->technique == ORL_TECHNIQUE_GATHER)
        state->cost_s[ORL_STAGE_RENDER] +=
            us * fmin((double)plan->photons_global * leaf_us, first_rays * first_us);
}

/* What photons that fly to sensors in mid-air take, at the most: who flies finds out how many. */
static double most_in_air_s(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_foresight *f = &plan->foresight;
    if (state->n_sensors == 0 || !(f->emitted[1] > 0) || !orl_air_may_be_lit(state->world))
        return 0;
    return (double)orl_run_most_in_air(state) * f->seconds[1] / f->emitted[1];
}

/* Nobody knows yet what pixels take, or paths; nor photons of which a pilot found too few, nor
 * whether flights to sensors end early, where that makes more of a difference than a guess may. */
void orl_run_foresee(struct orl_run_state *state)
{
    const double most_apart = 3.5;
    struct orl_plan *plan = &state->result->plan;
    struct orl_foresight *f = &plan->foresight;
    const bool known = f->known && plan->technique == ORL_TECHNIQUE_GATHER &&
                       state->job->n_views == 0 && !orl_goal_is_set(&state->job->goal);
    double least = known ? state->env->now_s(state->env->ctx) - state->started_s : NAN;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++)
        least += state->cost_s[i];
    const double most = least + most_in_air_s(state);
    f->job_s = most <= most_apart * least ? sqrt(least * most) : NAN;
    if (isfinite(f->job_s))
        state->cost_s[ORL_STAGE_RENDER] += f->job_s - least;
}

static double left_s(const struct orl_run_state *state, double fraction, double now)
{
    struct orl_ahead ahead = {
        .stage = state->stage, .fraction = fraction, .in_stage_s = now - state->stage_started};
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        ahead.foreseen_s[i] = state->cost_s[i];
        ahead.spent_s[i] = state->result->timings_s[i];
    }
    return orl_ahead_left_s(&ahead);
}

/* Of a job with a goal: of the time that it has, or is thought to take once a round has told. */
static double share_by_goal(const struct orl_run_state *state, double left, double now)
{
    const double elapsed = now - state->started_s;
    if (state->ends_s > state->started_s)
        return orl_ahead_share_of(elapsed, state->ends_s - state->started_s);
    return orl_ahead_share(elapsed, left + orl_ahead_rounds * (elapsed + left));
}

/* job_fraction is of the run itself, which may be a part of something larger. */
static void report(const struct orl_run_env *env, enum orl_stage stage, double fraction,
                   double job_fraction)
{
    const double part = env->part > 0 ? env->part : 1;
    if (env->progress)
        env->progress(env->ctx, stage, fraction, env->part_from + part * job_fraction);
}

void orl_run_progress(const struct orl_run_state *state, double fraction)
{
    if (!state->env->progress)
        return; /* and the clock is not looked at */
    fraction = fmin(fmax(fraction, 0), 1);
    const double now = state->env->now_s(state->env->ctx);
    const double left = left_s(state, fraction, now);
    const double share = orl_goal_is_set(&state->job->goal)
                             ? share_by_goal(state, left, now)
                             : orl_ahead_share(now - state->started_s, left);
    *state->told = fmax(*state->told, share);
    report(state->env, state->stage, fraction, *state->told);
}

/* Books the time since the stage began. */
static void leave(struct orl_run_state *state)
{
    const double now = state->env->now_s(state->env->ctx);
    state->result->timings_s[state->stage] += now - state->stage_started;
    state->stage_started = now;
}

void orl_run_book(struct orl_run_state *state, enum orl_stage stage, double seconds)
{
    state->result->timings_s[stage] += seconds;
    state->stage_started += seconds;
}

void orl_run_enter(struct orl_run_state *state, enum orl_stage stage)
{
    leave(state);
    state->stage = stage;
    orl_run_progress(state, 0);
}

void orl_run_warn(struct orl_run_state *state, const char *format, ...)
{
    struct orl_result *r = state->result;
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (state->env->warned)
        state->env->warned(state->env->ctx, text);
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    if (!grown)
        return;
    r->warnings = grown;
    grown[r->n_warnings] = strdup(text);
    if (grown[r->n_warnings])
        r->n_warnings++;
}

static int load_sensors(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_job *job = state->job;
    state->sensors = job->sensors;
    state->n_sensors = job->n_sensors;
    if (!job->sensors_file)
        return 0;
    const int code = orl_sensors_load(state->env->files, job->sensors_file, &state->sensors,
                                      &state->n_sensors, err);
    state->sensors_owned = code == 0;
    return code;
}

/* What a job and its plan have in common: everything before photons. */
static int prepare(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_job *job = state->job;
    orl_run_progress(state, 0);
    int code = orl_job_validate(job, err);
    if (code == 0 && job->n_skies > 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "the job has several skies: run each by itself");
    if (code == 0 && (job->n_scene_files == 0 || sodium_init() < 0))
        code = orl_error_set(err, ORL_ERR_INVALID, "the job names no scene files");
    if (code == 0)
        code = load_sensors(state, err);
    orl_run_guess_costs(state);
    if (code == 0)
        code = orl_run_load(state, err);
    if (code < 0)
        return code;
    orl_run_enter(state, ORL_STAGE_PLAN);
    code = orl_run_plan(state, err);
    return code == 0 && orl_crew_cancelled(state->env->crew)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while planning")
               : code;
}

int orl_run_need_emission(struct orl_run_state *state, struct orl_error *err)
{
    return state->emission ? 0
                           : orl_emission_new(state->world, state->job->seed, state->env->crew,
                                              &state->emission, err);
}

int orl_run_technique(struct orl_run_state *state, struct orl_error *err)
{
    return state->result->plan.technique == ORL_TECHNIQUE_BACKWARD ? orl_run_backward(state, err)
                                                                   : orl_run_gather(state, err);
}

static int run_stages(struct orl_run_state *state, struct orl_error *err)
{
    const bool in_rounds = orl_goal_is_set(&state->job->goal);
    int code = prepare(state, err);
    if (code == 0)
        code = in_rounds ? orl_run_rounds(state, err) : orl_run_technique(state, err);
    if (code == 0)
        code = orl_run_judge_darkness(state, err);
    if (code == 0)
        code = orl_run_judge_chance(state, err);
    if (code == 0) {
        leave(state);
        orl_run_judge_health(state);
    }
    if (code == 0 && !in_rounds)
        orl_run_cost(state);
    return code;
}

/* *scene: the job's, or NULL, and then what is read. */
static int run(const struct orl_job *job, const struct orl_run_env *env, struct orl_scene **scene,
               int (*stages)(struct orl_run_state *state, struct orl_error *err),
               struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_result result = {.threads = orl_crew_size(env->crew), .seed = job->seed};
    struct orl_run_state state = {
        .job = job, .env = env, .result = &result, .only_plan = stages == prepare};
    const double started = env->now_s(env->ctx);
    double told = 0;
    int code;
    if (*scene)
        state.scene = orl_scene_hold(*scene);
    state.told = &told;
    state.n_sensors = job->n_sensors;
    orl_run_guess_costs(&state);
    state.stage_started = state.started_s = started;
    if (job->goal.deadline_s > 0)
        state.ends_s = started + job->goal.deadline_s;
    orl_crew_heed(env->crew, env->cancel);
    state.searches = calloc(orl_crew_size(env->crew), sizeof *state.searches);
    if (state.searches)
        code = stages(&state, err);
    else
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_crew_heed(env->crew, NULL);
    leave(&state);
    result.total_s = env->now_s(env->ctx) - started;
    orl_run_forget_looks(&state);
    orl_run_release_maps(&state);
    orl_run_forget_backward(&state);
    orl_emission_free(state.emission);
    orl_world_free(state.world);
    orl_lights_release(state.lights);
    if (*scene)
        orl_scene_release(state.scene);
    else
        *scene = state.scene;
    if (state.sensors_owned)
        free(state.sensors);
    free(state.searches);
    if (env->spent)
        env->spent(env->ctx, &result);
    if (code < 0) {
        orl_result_done(&result);
        return code;
    }
    report(env, ORL_STAGE_RENDER, 1, 1);
    *ret_result = result;
    return 0;
}

int orl_run_of_scene(const struct orl_job *job, const struct orl_run_env *env,
                     struct orl_scene **scene, struct orl_result *ret_result, struct orl_error *err)
{
    return run(job, env, scene, run_stages, ret_result, err);
}

int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code = run(job, env, &scene, run_stages, ret_result, err);
    orl_scene_release(scene);
    return code;
}

int orl_plan_job(const struct orl_job *job, const struct orl_run_env *env,
                 struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code = run(job, env, &scene, prepare, ret_result, err);
    orl_scene_release(scene);
    return code;
}
