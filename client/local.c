#include "local.h"

#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>

#include <oriel/files.h>

#include "files.h"
#include "follow.h"
#include "plan_table.h"
#include "progress.h"
#include "result_json.h"
#include "study_json.h"
#include "study_table.h"

/* The one variable outside a function: a signal handler has no other way to say anything. */
static atomic_bool interrupted;

static void on_interrupt(int number)
{
    atomic_store(&interrupted, true);
    signal(number, SIG_DFL); /* a second Ctrl-C ends the program at once */
}

void orl_local_catch_interrupts(void)
{
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = SA_RESTART};

    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

uint32_t orl_local_cores(void)
{
    cpu_set_t set;

    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
        return (uint32_t)CPU_COUNT(&set);
    return 1;
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction)
{
    (void)stage_fraction;
    orl_progress_show(ctx, orl_stage_name(stage), job_fraction, -1);
}

static void on_plan(void *ctx, const struct orl_plan *plan)
{
    char text[128];

    orl_format_plan(plan, text, sizeof text);
    orl_progress_note(ctx, "plan: %s", text);
}

static void on_map(void *ctx, const struct orl_map_info *info)
{
    json_t *map = orl_map_info_to_json(info);
    char text[256];

    if (map) {
        orl_format_map(map, text, sizeof text);
        orl_progress_note(ctx, "%s", text);
    }
    json_decref(map);
}

static void on_round(void *ctx, const struct orl_result *result)
{
    const struct orl_outcome *outcome = &result->outcome;
    char error[32] = "not known yet";

    if (outcome->achieved >= 0)
        snprintf(error, sizeof error, "%.3g %%", 100 * outcome->achieved);
    orl_progress_note(ctx, "round %u: error %s, %.1f s", outcome->rounds, error, result->total_s);
}

/* Gives env what both commands need. */
static int prepare(struct orl_run_env *env, uint32_t threads, struct orl_error *err)
{
    env->cancel = &interrupted;
    env->now_s = orl_clock_s;
    env->crew = orl_crew_start(threads);
    return env->crew ? 0
                     : orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
}

int orl_local_run(const struct orl_job *job, const char *folder, const char *output,
                  uint32_t threads, struct orl_result *ret_result, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_folder_store maps;
    const struct orl_map_store store = orl_map_store_in_folder(&maps);
    struct orl_progress progress;
    struct orl_run_env env = {.files = &files,
                              .store = &store,
                              .output_folder = output,
                              .progress = on_progress,
                              .plan_ready = on_plan,
                              .map_ready = on_map,
                              .round_ready = on_round,
                              .ctx = &progress};
    int rc = orl_join_path(output, "maps", maps.folder, sizeof maps.folder, err);

    if (rc == 0)
        rc = prepare(&env, threads, err);
    if (rc)
        return rc;
    orl_progress_start(&progress);
    rc = orl_run(job, &env, ret_result, err);
    orl_progress_end(&progress);
    orl_crew_stop(env.crew);
    return rc;
}

int orl_local_plan(const struct orl_job *job, const char *folder, uint32_t threads,
                   struct orl_result *ret_result, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_run_env env = {.files = &files};
    int rc = prepare(&env, threads, err);

    if (rc)
        return rc;
    rc = orl_plan_job(job, &env, ret_result, err);
    orl_crew_stop(env.crew);
    return rc;
}

static void on_study_progress(void *ctx, const struct orl_study_step *step)
{
    orl_progress_show(ctx, orl_study_step_name(step), step->fraction, -1);
}

static void on_study_point(void *ctx, const struct orl_study_point *point)
{
    json_t *json = orl_study_point_in_short(point);
    char text[160];

    if (json) {
        orl_format_study_point(json, text, sizeof text);
        orl_progress_note(ctx, "%s", text);
    }
    json_decref(json);
}

int orl_local_study(const struct orl_study_request *request, const char *folder, const char *output,
                    uint32_t threads, struct orl_study *ret_study, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_progress progress;
    const struct orl_study_env env = {.crew = orl_crew_start(threads),
                                      .files = &files,
                                      .work_folder = output,
                                      .cancel = &interrupted,
                                      .now_s = orl_clock_s,
                                      .progress = on_study_progress,
                                      .point_ready = on_study_point,
                                      .ctx = &progress};
    int rc;

    if (!env.crew)
        return orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
    orl_progress_start(&progress);
    rc = orl_study_run(request, &env, ret_study, err);
    orl_progress_end(&progress);
    orl_crew_stop(env.crew);
    return rc;
}
