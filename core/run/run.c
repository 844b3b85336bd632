#include <oriel/run.h>

#include <sodium.h>
#include <stdlib.h>

#include <oriel/paths.h>

#include "run/cache/scene_cache.h"
#include "run/goals/accuracy_curve.h"
#include "run/goals/round_cost.h"
#include "run/goals/rounds.h"
#include "run/request/grids.h"
#include "run/stages/sensor_run.h"
#include "scene/material/lobed.h"
#include "scene/material/pattern.h"

static int load_sensors(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_job *job = state->job;
    state->sensors = job->sensors;
    state->n_sensors = job->n_sensors;
    if (job->n_grids > 0)
        return orl_run_load_grids(state, err);
    if (!job->sensors_file)
        return 0;
    const int code = orl_sensors_load(state->env->files, job->sensors_file, state->env->cancel,
                                      &state->sensors, &state->n_sensors, err);
    state->sensors_owned = code == 0;
    return code;
}

/* Refuses an accuracy goal for materials whose lobes are too narrow to sample reliably. */
static int admit_goal(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_goal *const goal = &state->job->goal;
    const struct orl_world *const world = state->world;
    const bool promised = goal->relative_error > 0 || goal->dgp_error > 0;
    const struct orl_pattern *const lobes =
        promised ? orl_lobed_narrow_of(world->geometry, world->materials) : NULL;
    if (!lobes)
        return 0;
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "its lobes are narrower than draws are made for: no accuracy can be promised "
                  "where it is met");
    orl_error_at(err, lobes->file, lobes->line, lobes->name);
    orl_error_hint(err, "describe it as a BSDF, or ask for photons and samples instead");
    return ORL_ERR_UNSUPPORTED;
}

/* Refuses mist with techniques that do not support it. */
static int admit_mist(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_scene *const scene = state->world->scene;
    uint32_t facet = 0;
    const struct orl_plan *plan = &state->result->plan;
    if (!(orl_paths_missed(plan->technique, plan->paths) & 1U << ORL_PATHS_MIST))
        return 0;
    while (!(orl_facet_area(scene->mist, facet) > 0))
        facet++;
    const struct orl_surface_label label = orl_scene_label_of(scene, facet);
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "the technique %s does not follow light through mist, which the surface '%.100s' "
                  "is of",
                  orl_technique_name(plan->technique), label.name);
    orl_error_at(err, label.file, label.line, NULL);
    orl_error_hint(err, "use the technique backward, which is chosen where the job names none");
    return ORL_ERR_UNSUPPORTED;
}

/* Runs everything before photons, for jobs and plans alike. */
static int prepare_run(struct orl_run_state *state, struct orl_error *err)
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
    if (code == 0 &&
        !state->pilot) /* a pilot reports it as the reason for no curve (orl_run_pilot) */
        code = admit_goal(state, err);
    if (code == 0)
        code = admit_mist(state, err);
    return code == 0 && orl_crew_cancelled(state->env->crew)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while planning")
               : code;
}

/* Renders the job, in rounds or without. */
static int render_job(struct orl_run_state *state, struct orl_error *err)
{
    if (orl_goal_is_set(&state->job->goal) || orl_run_batches(state) > 1)
        return orl_run_rounds(state, err);
    return orl_run_technique(state, err);
}

/* Predicts the cost of more accuracy for a job without rounds; rounds predict it themselves. */
static void predict_cost(struct orl_run_state *state)
{
    orl_run_leave(state);
    if (!orl_goal_is_set(&state->job->goal) && orl_run_batches(state) == 1)
        orl_run_cost(state);
}

/* Compares the sensors with photons and with plain path tracing. */
static int check_sensors(struct orl_run_state *state, struct orl_error *err)
{
    const size_t warnings = state->result->n_warnings;
    int code = orl_run_judge_chance(state, err);
    if (code == 0)
        code = orl_run_cross_check(state, err);
    if (code == 0)
        code = orl_sensor_run_again(state, warnings, err);
    if (code == 0)
        orl_run_heed_doubts(state);
    return code;
}

static int render_and_check(struct orl_run_state *state, struct orl_error *err)
{
    int code = render_job(state, err);
    if (code == 0)
        code = check_sensors(state, err);
    if (code == 0)
        predict_cost(state);
    return code;
}

static int finish_run(struct orl_run_state *state, struct orl_error *err)
{
    int code = orl_run_judge_darkness(state, err);
    if (code == 0) {
        orl_run_judge_health(state);
        code = orl_run_write_sensors(state, err);
    }
    return code == 0 ? orl_run_write_grids(state, err) : code;
}

static int run_stages(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_run sensors = {.made = false};
    int code = prepare_run(state, err);
    if (code == 0)
        code = orl_sensor_run_make(state, &sensors, err);
    if (code == 0)
        code = render_and_check(state, err);
    orl_sensor_run_join(state, &sensors);
    return code == 0 ? finish_run(state, err) : code;
}

static int sensor_stages(struct orl_run_state *state, struct orl_error *err)
{
    state->only_sensors = true;
    const int code = prepare_run(state, err);
    return code == 0 ? render_and_check(state, err) : code;
}

static int plan_stages(struct orl_run_state *state, struct orl_error *err)
{
    const int code = prepare_run(state, err);
    if (code == 0)
        state->result->no_curve = orl_run_why_no_curve(state);
    return code;
}

static int try_stages(struct orl_run_state *state, struct orl_error *err)
{
    const int code = prepare_run(state, err);
    return code == 0 ? orl_run_pilot(state, err) : code;
}

/* Stages to run, and an optional pilot to fill in. */
struct course {
    int (*stages)(struct orl_run_state *state, struct orl_error *err);
    struct orl_pilot *pilot;
};

/* Runs a job with resolved views. *scene: in: a scene already loaded, or NULL; out: the scene that
 * was used. */
static int run_settled(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene **scene, const struct course *course,
                       struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_result result = {.threads = orl_crew_size(env->crew), .seed = job->seed};
    struct orl_run_state state = {.job = job,
                                  .env = env,
                                  .result = &result,
                                  .run_sensors = orl_run_only_sensors,
                                  .only_plan = course->stages == plan_stages,
                                  .pilot = course->pilot};
    const double started = env->now_s(env->ctx);
    struct orl_told told = {.at_s = started};
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
        code = course->stages(&state, err);
    else
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_crew_heed(env->crew, NULL);
    orl_run_leave(&state);
    result.total_s = env->now_s(env->ctx) - started;
    orl_run_forget_pixels(&state);
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
    free(state.rays);
    if (env->spent)
        env->spent(env->ctx, &result);
    if (code < 0) {
        orl_result_done(&result);
        return code;
    }
    orl_run_report(env, ORL_STAGE_RENDER, 1,
                   &(struct orl_run_report){.share = 1, .elapsed_s = result.total_s});
    *ret_result = result;
    return 0;
}

int orl_run_only_sensors(const struct orl_job *job, const struct orl_run_env *env,
                         struct orl_scene *scene, struct orl_result *ret_result,
                         struct orl_error *err)
{
    return run_settled(job, env, &scene, &(struct course){.stages = sensor_stages}, ret_result,
                       err);
}

/* Resolves views in files, then runs the job. */
static int run_job(const struct orl_job *job, const struct orl_run_env *env,
                   struct orl_scene **scene, const struct course *course,
                   struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_job settled = *job;
    int code = orl_run_views(job, env->files, &settled.views, err);
    if (code == 0)
        code = run_settled(&settled, env, scene, course, ret_result, err);
    if (settled.views != job->views)
        orl_run_views_done(job, settled.views);
    return code;
}

int orl_run_of_scene(const struct orl_job *job, const struct orl_run_env *env,
                     struct orl_scene **scene, struct orl_result *ret_result, struct orl_error *err)
{
    return run_job(job, env, scene, &(struct course){.stages = run_stages}, ret_result, err);
}

int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code =
        run_job(job, env, &scene, &(struct course){.stages = run_stages}, ret_result, err);
    orl_scene_release(scene);
    return code;
}

int orl_plan_job(const struct orl_job *job, const struct orl_run_env *env,
                 struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code =
        run_job(job, env, &scene, &(struct course){.stages = plan_stages}, ret_result, err);
    orl_scene_release(scene);
    return code;
}

int orl_plan_curve(const struct orl_job *job, const struct orl_run_env *env,
                   enum orl_technique technique, struct orl_curve *ret_curve, struct orl_error *err)
{
    const struct orl_job tried = orl_pilot_job(job, technique);
    struct orl_curve curve = {.technique = technique, .threads = orl_crew_size(env->crew)};
    struct orl_pilot pilot = {.sensor_times = 1, .view_times = 1, .curve = &curve};
    struct orl_result result = {0};
    struct orl_scene *scene = NULL;
    const int code =
        run_job(&tried, env, &scene, &(struct course){try_stages, &pilot}, &result, err);
    orl_scene_release(scene);
    orl_result_done(&result);
    if (code == 0)
        *ret_curve = curve;
    return code;
}
