#include <oriel/job/run.h>

#include <sodium.h>
#include <stdlib.h>

#include <oriel/job/paths.h>

#include "run/cache/emission_cache.h"
#include "run/cache/scene_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/estimate/round_cost.h"
#include "run/goals/rounds.h"
#include "run/output/output_files.h"
#include "run/request/job_inputs.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"
#include "scene/material/function_brdf/function_brdf_check.h"
#include "scene/material/patterns/pattern.h"

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
static int check_goal_supported(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_goal *const goal = &state->job->goal;
    const struct orl_lit_scene *const lit_scene = state->lit_scene;
    const bool has_error_goal = goal->relative_error > 0 || goal->dgp_error > 0;
    const struct orl_pattern *const lobes =
        has_error_goal ? orl_find_narrow_lobes(lit_scene->geometry, lit_scene->materials) : NULL;
    if (!lobes)
        return 0;
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "its lobes are too narrow to sample reliably, so an accuracy goal cannot be met");
    orl_error_at(err, lobes->file, lobes->line, lobes->name);
    orl_error_hint(err, "describe it as a BSDF, or ask for photons and samples instead");
    return ORL_ERR_UNSUPPORTED;
}

/* Refuses participating media with techniques that do not support it. */
static int check_volume_supported(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_scene *const scene = state->lit_scene->scene;
    uint32_t facet = 0;
    const struct orl_plan *plan = &state->result->plan;
    if (!(orl_paths_missed(plan->technique, plan->paths) & 1U << ORL_PATHS_VOLUME))
        return 0;
    while (!(orl_facet_area(scene->mist, facet) > 0))
        facet++;
    const struct orl_surface_label label = orl_scene_label_of(scene, facet);
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "the technique %s does not simulate mist (surface '%.100s')",
                  orl_technique_name(plan->technique), label.name);
    orl_error_at(err, label.file, label.line, NULL);
    orl_error_hint(err, "use the technique backward, which is the default for such scenes");
    return ORL_ERR_UNSUPPORTED;
}

/* Runs everything before photons, for jobs and plans alike. */
static int prepare_run(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_job *job = state->job;
    orl_run_report_progress(state, 0);
    int code = orl_job_validate(job, err);
    if (code == 0 && job->n_skies > 0)
        code = orl_error_set(err, ORL_ERR_INVALID,
                             "the job has several skies: run each one separately");
    if (code == 0 && (job->n_scene_files == 0 || sodium_init() < 0))
        code = orl_error_set(err, ORL_ERR_INVALID, "the job names no scene files");
    if (code == 0)
        code = load_sensors(state, err);
    orl_run_estimate_stages(state);
    if (code == 0)
        code = orl_run_load_scene(state, err);
    if (code < 0)
        return code;
    orl_run_begin_stage(state, ORL_STAGE_PLAN);
    code = orl_run_plan(state, err);
    if (code == 0 &&
        !state->pilot) /* a pilot reports it as the reason for no curve (orl_run_pilot) */
        code = check_goal_supported(state, err);
    if (code == 0)
        code = check_volume_supported(state, err);
    return code == 0 && orl_thread_pool_cancelled(state->env->pool)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while planning")
               : code;
}

/* Renders the job, in rounds or without. */
static int render_job(struct orl_run_state *state, struct orl_error *err)
{
    if (orl_goal_is_set(&state->job->goal) || orl_run_count_batches(state) > 1)
        return orl_run_rounds(state, err);
    return orl_run_technique(state, err);
}

/* Predicts the cost of more accuracy for a job without rounds; rounds predict it themselves. */
static void predict_cost(struct orl_run_state *state)
{
    orl_run_end_stage(state);
    if (!orl_goal_is_set(&state->job->goal) && orl_run_count_batches(state) == 1)
        orl_run_compute_cost(state);
}

/* Compares the sensors with photons and with plain path tracing. */
static int check_sensors(struct orl_run_state *state, struct orl_error *err)
{
    const size_t warnings = state->result->n_warnings;
    int code = orl_run_diagnose_missed_light(state, err);
    if (code == 0)
        code = orl_run_cross_check(state, err);
    if (code == 0)
        code = orl_sensor_run_retry(state, warnings, err);
    if (code == 0)
        orl_run_apply_unreliable(state);
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
    int code = orl_run_diagnose_dark(state, err);
    if (code == 0) {
        orl_run_diagnose_health(state);
        code = orl_run_write_sensors(state, err);
    }
    return code == 0 ? orl_run_write_grids(state, err) : code;
}

static int run_stages(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_sensor_run sensors = {.is_separate = false};
    int code = prepare_run(state, err);
    if (code == 0)
        code = orl_sensor_run_start(state, &sensors, err);
    if (code == 0)
        code = render_and_check(state, err);
    orl_sensor_run_join(state, &sensors);
    return code == 0 ? finish_run(state, err) : code;
}

static int sensor_stages(struct orl_run_state *state, struct orl_error *err)
{
    const int code = prepare_run(state, err);
    return code == 0 ? render_and_check(state, err) : code;
}

static int plan_stages(struct orl_run_state *state, struct orl_error *err)
{
    const int code = prepare_run(state, err);
    if (code == 0)
        state->result->no_curve = orl_run_no_curve_reason(state);
    return code;
}

static int pilot_stages(struct orl_run_state *state, struct orl_error *err)
{
    const int code = prepare_run(state, err);
    return code == 0 ? orl_run_pilot(state, err) : code;
}

static int run_by_mode(struct orl_run_state *state, struct orl_error *err)
{
    switch (state->mode) {
    case ORL_RUN_SENSORS:
        return sensor_stages(state, err);
    case ORL_RUN_PLAN:
        return plan_stages(state, err);
    case ORL_RUN_PILOT:
        return pilot_stages(state, err);
    case ORL_RUN_ALL:
        break;
    }
    return run_stages(state, err);
}

/* Which stages run, and the pilot to fill in, with ORL_RUN_PILOT only. */
struct run_mode {
    enum orl_run_mode mode;
    struct orl_pilot *pilot;
};

/* Runs a job with resolved views. *scene: in: a scene already loaded, or NULL; out: the scene that
 * was used. */
static int run_resolved(const struct orl_job *job, const struct orl_run_env *env,
                        struct orl_scene **scene, const struct run_mode *run_mode,
                        struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_result result = {.threads = orl_thread_pool_size(env->pool), .seed = job->seed};
    struct orl_run_state state = {.job = job,
                                  .env = env,
                                  .result = &result,
                                  .run_sensors = orl_run_only_sensors,
                                  .mode = run_mode->mode,
                                  .pilot = run_mode->pilot};
    const double started = env->now_s(env->ctx);
    struct orl_progress progress = {.at_s = started};
    int code;
    if (*scene)
        state.scene = orl_scene_hold(*scene);
    state.progress = &progress;
    state.n_sensors = job->n_sensors;
    orl_run_estimate_stages(&state);
    state.clock.stage_started = state.clock.started_s = started;
    if (job->goal.deadline_s > 0)
        state.clock.deadline_at_s = started + job->goal.deadline_s;
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    state.searches = calloc(orl_thread_pool_size(env->pool), sizeof *state.searches);
    if (state.searches)
        code = run_by_mode(&state, err);
    else
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_thread_pool_set_cancel(env->pool, NULL);
    orl_run_end_stage(&state);
    result.total_s = env->now_s(env->ctx) - started;
    orl_run_free_pixels(&state);
    orl_run_release_maps(&state);
    orl_renderer_destroy(&state.renderer);
    orl_run_release_emission(&state);
    orl_lit_scene_free(state.lit_scene);
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
    orl_progress_report(env, ORL_STAGE_RENDER, 1,
                        &(struct orl_progress_report){.share = 1, .elapsed_s = result.total_s});
    *ret_result = result;
    return 0;
}

int orl_run_only_sensors(const struct orl_job *job, const struct orl_run_env *env,
                         struct orl_scene *scene, struct orl_result *ret_result,
                         struct orl_error *err)
{
    return run_resolved(job, env, &scene, &(struct run_mode){.mode = ORL_RUN_SENSORS}, ret_result,
                        err);
}

/* Resolves views in files, then runs the job. */
static int run_job(const struct orl_job *job, const struct orl_run_env *env,
                   struct orl_scene **scene, const struct run_mode *run_mode,
                   struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_job resolved = *job;
    int code = orl_run_resolve_views(job, env->files, &resolved.views, err);
    if (code == 0)
        code = run_resolved(&resolved, env, scene, run_mode, ret_result, err);
    if (resolved.views != job->views)
        orl_run_views_done(job, resolved.views);
    return code;
}

int orl_run_with_scene(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene **scene, struct orl_result *ret_result,
                       struct orl_error *err)
{
    return run_job(job, env, scene, &(struct run_mode){.mode = ORL_RUN_ALL}, ret_result, err);
}

int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code =
        run_job(job, env, &scene, &(struct run_mode){.mode = ORL_RUN_ALL}, ret_result, err);
    orl_scene_release(scene);
    return code;
}

int orl_plan_job(const struct orl_job *job, const struct orl_run_env *env,
                 struct orl_result *ret_result, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    const int code =
        run_job(job, env, &scene, &(struct run_mode){.mode = ORL_RUN_PLAN}, ret_result, err);
    orl_scene_release(scene);
    return code;
}

int orl_plan_accuracy_curve(const struct orl_job *job, const struct orl_run_env *env,
                            enum orl_technique technique, struct orl_accuracy_curve *ret_curve,
                            struct orl_error *err)
{
    const struct orl_job pilot_job = orl_pilot_job(job, technique);
    struct orl_accuracy_curve curve = {.technique = technique,
                                       .threads = orl_thread_pool_size(env->pool)};
    struct orl_pilot pilot = {.sensor_factor = 1, .view_factor = 1, .curve = &curve};
    struct orl_result result = {0};
    struct orl_scene *scene = NULL;
    const int code =
        run_job(&pilot_job, env, &scene, &(struct run_mode){ORL_RUN_PILOT, &pilot}, &result, err);
    orl_scene_release(scene);
    orl_result_done(&result);
    if (code == 0)
        *ret_curve = curve;
    return code;
}
