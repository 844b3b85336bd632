#include "commands/local.h"

#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/job/skies.h>

#include "annual_job/annual_job.h"
#include "daemon_commands/follow_job.h"
#include "distributed/atomic_files.h"
#include "input/input_folders.h"
#include "job/study_json.h"
#include "output/reports.h"
#include "output/terminal.h"
#include "result/result_json.h"
#include "view/view_json.h"
#include "json/decode.h"

/* Globals, because a signal handler can use nothing else. */
static atomic_bool interrupted;

/* Seconds after which an interrupted run is forced to exit; its files are still whole or
 * absent. A run with parts in other processes has no limit, because it cancels them first. */
enum { STOP_S = 5 };
static atomic_bool has_parts;

static void on_stop_limit(int number)
{
    static const char text[] = "\noriel: terminated, because it did not stop within 5 s\n";
    (void)number;
    if (write(STDERR_FILENO, text, sizeof text - 1) < 0)
        _exit(ORL_EXIT_FAILED);
    _exit(ORL_EXIT_FAILED);
}

static void on_interrupt(int number)
{
    atomic_store(&interrupted, true);
    if (!atomic_load(&has_parts))
        alarm(STOP_S);
    signal(number, SIG_DFL); /* a second Ctrl-C ends the program at once */
}

static void catch_interrupts(void)
{
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    action.sa_handler = on_stop_limit;
    sigaction(SIGALRM, &action, NULL);
    orl_json_set_cancel(&interrupted);
}

/* Returns the processors available to this process: fewer than all under taskset or in a
 * container. */
static uint32_t count_cores(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
        return (uint32_t)CPU_COUNT(&set);
    return 1;
}

/* Reads --threads; reports an invalid value. */
static int read_threads(const struct orl_subcommand *self, struct orl_local_line *line)
{
    uint64_t threads = line->threads > 0 ? line->threads : count_cores();
    if (line->threads_text && !orl_parse_count(line->threads_text, 1, 1024, &threads))
        return orl_usage_error(self, "--threads takes a number from 1 to 1024, not \"%s\"",
                               line->threads_text);
    line->threads = (uint32_t)threads;
    return ORL_EXIT_OK;
}

bool orl_local_parse(const struct orl_subcommand *self, int argc, char **argv,
                     const struct orl_option *options, size_t n_options,
                     struct orl_local_line *line, int *ret_exit)
{
    if (!orl_options_parse(self, argc, argv, options, n_options, line->may_be_bare ? 0 : 1,
                           line->most ? line->most : 1, &line->all, ret_exit))
        return false;
    line->operand = line->all.count > 0 ? line->all.items[0] : NULL;
    *ret_exit = line->writes && !line->output ? orl_usage_error(self, "-o DIR is missing")
                                              : read_threads(self, line);
    if (*ret_exit == 0)
        catch_interrupts();
    return *ret_exit == 0;
}

/* Environment of a run in this process, with progress on stderr. */
struct local {
    struct orl_files files;
    struct orl_folder_store maps;
    struct orl_map_store store;
    struct orl_progress_line progress;
    struct orl_run_env env;
    char *warnings; /* warnings printed so far, one per line, behind an empty line */
};

/* Prints each warning once, as soon as it is known, if possible before rendering. */
static void on_warned(void *ctx, const char *warning)
{
    struct local *local = ctx;
    const char *const printed = local->warnings ? local->warnings : "\n";
    char *grown = NULL, *line = NULL;
    if (asprintf(&line, "\n%s\n", warning) < 0)
        return;
    const bool known = strstr(printed, line) != NULL;
    free(line);
    if (known)
        return;
    orl_progress_warn(&local->progress, warning);
    if (asprintf(&grown, "%s%s\n", printed, warning) >= 0) {
        free(local->warnings);
        local->warnings = grown;
    }
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                        double left_s)
{
    (void)stage_fraction;
    orl_progress_show_local(&((struct local *)ctx)->progress, orl_stage_name(stage), job_fraction,
                            left_s);
}

static void on_plan(void *ctx, const struct orl_plan *plan)
{
    char text[128];
    orl_format_plan(plan, text, sizeof text);
    orl_progress_note(&((struct local *)ctx)->progress, "plan: %s", text);
}

static void on_map(void *ctx, const struct orl_map_info *info)
{
    json_t *map = orl_map_info_to_json(info);
    char text[256];
    if (map) {
        orl_format_map(map, text, sizeof text);
        orl_progress_note(&((struct local *)ctx)->progress, "%s", text);
    }
    json_decref(map);
}

static void on_round(void *ctx, const struct orl_result *result)
{
    const struct orl_outcome *outcome = &result->outcome;
    char error[32] = "not known yet";
    if (outcome->achieved >= 0 && outcome->goal.dgp_error > 0)
        snprintf(error, sizeof error, "of DGP %.2g", outcome->achieved);
    else if (outcome->achieved >= 0)
        snprintf(error, sizeof error, "%.3g %%", 100 * outcome->achieved);
    orl_progress_note(&((struct local *)ctx)->progress, "round %u: error %s, %.1f s",
                      outcome->rounds, error, result->total_s);
}

/* Sets the members of env that all commands need. */
static int init_env(struct orl_run_env *env, uint32_t threads, struct orl_error *err)
{
    env->cancel = &interrupted;
    env->now_s = orl_clock_s;
    env->pool = orl_thread_pool_start(threads);
    return env->pool ? 0
                     : orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
}

static int local_start(struct local *local, const char *folder, const char *output,
                       uint32_t threads, struct orl_error *err)
{
    local->files = orl_raypath_files(folder);
    local->store = orl_map_store_in_folder(&local->maps);
    local->env = (struct orl_run_env){.files = &local->files,
                                      .store = &local->store,
                                      .output_folder = output,
                                      .progress = on_progress,
                                      .plan_ready = on_plan,
                                      .map_ready = on_map,
                                      .warned = on_warned,
                                      .round_ready = on_round,
                                      .ctx = local};
    local->warnings = NULL;
    int rc = orl_join_path(output, "maps", local->maps.folder, sizeof local->maps.folder, err);
    if (rc == 0)
        rc = init_env(&local->env, threads, err);
    if (rc == 0)
        orl_progress_start(&local->progress);
    return rc;
}

static void local_stop(struct local *local)
{
    orl_progress_end(&local->progress);
    orl_thread_pool_stop(local->env.pool);
    free(local->warnings);
}

void orl_local_has_parts(void)
{
    atomic_store(&has_parts, true);
}

const atomic_bool *orl_local_interrupted(void)
{
    return &interrupted;
}

static void set_distribution(struct local *local, const struct orl_local_distribution *distribution)
{
    if (!distribution)
        return;
    local->env.tasks = distribution->tasks;
    local->env.store = distribution->store;
}

int orl_local_run(const struct orl_job *job, const char *folder, const char *output,
                  uint32_t threads, const struct orl_local_distribution *distribution,
                  struct orl_result *ret_result, struct orl_error *err)
{
    struct local local;
    int rc = local_start(&local, folder, output, threads, err);
    if (rc)
        return rc;
    set_distribution(&local, distribution);
    rc = orl_run(job, &local.env, ret_result, err);
    local_stop(&local);
    return rc;
}

/* A job with several skies while it runs. */
struct skies {
    struct local local;
    const struct orl_job *job;
    json_t *results;
};

static void on_sky(void *ctx, size_t index, const struct orl_job *job, const char *file_prefix)
{
    struct skies *skies = ctx;
    (void)job, (void)file_prefix;
    orl_progress_note(&skies->local.progress, "sky %s (%zu of %zu)", skies->job->skies[index].name,
                      index + 1, skies->job->n_skies);
}

static int on_sky_done(void *ctx, size_t index, const struct orl_result *result,
                       struct orl_error *err)
{
    struct skies *skies = ctx;
    const char *name = skies->job->skies[index].name;
    json_t *json = orl_sky_result_to_json(result, name);
    char file[128], path[4096];
    snprintf(file, sizeof file, "%s.json", name);
    int rc = orl_join_path(skies->local.env.output_folder, file, path, sizeof path, err);
    if (rc == 0)
        rc = orl_write_json(path, json, err);
    if (rc == 0 && orl_skies_result_add(skies->results, json))
        rc = orl_error_no_memory(err);
    json_decref(json);
    return rc;
}

int orl_local_run_skies(const struct orl_job *job, const char *folder, const char *output,
                        uint32_t threads, const struct orl_local_distribution *distribution,
                        json_t **ret_results, struct orl_error *err)
{
    struct skies skies = {.job = job, .results = orl_skies_result_new(job->seed, threads)};
    const struct orl_skies_env env = {.ctx = &skies, .begins = on_sky, .done = on_sky_done};
    int rc = skies.results ? local_start(&skies.local, folder, output, threads, err)
                           : orl_error_no_memory(err);
    if (rc == 0) {
        set_distribution(&skies.local, distribution);
        rc = orl_run_skies(job, &skies.local.env, &env, err);
        if (rc == 0)
            rc = orl_sequence_draw(job, output, skies.local.env.cancel, skies.results, err);
        local_stop(&skies.local);
    }
    if (rc == 0 && orl_skies_result_end(skies.results, "succeeded"))
        rc = orl_error_no_memory(err);
    if (rc)
        json_decref(skies.results);
    else
        *ret_results = skies.results;
    return rc;
}

int orl_local_plan(const struct orl_job *job, const char *folder, uint32_t threads,
                   orl_local_plan_callback *on_result, void *ctx, struct orl_error *err)
{
    const struct orl_files files = orl_raypath_files(folder);
    struct orl_run_env env = {.files = &files};
    int rc = init_env(&env, threads, err);
    if (rc)
        return rc;
    rc = orl_plan_skies(job, &env, SIZE_MAX, on_result, ctx, err);
    orl_thread_pool_stop(env.pool);
    return rc;
}

/* Size of a year's in-memory cache in bytes. Caching is safe because local files do not change
 * during a job. */
enum { YEAR_SHELF = 1 << 30 };

/* A year's job while it runs. */
struct year {
    struct local local; /* first, because callbacks get a pointer to it */
    const struct orl_local_callback *on_result;
};

static void on_year_round(void *ctx, const struct orl_annual_refinement *r)
{
    struct local *local = ctx;
    orl_progress_note(&local->progress, "round %u: %s: %.4g [%.4g, %.4g], %s; %zu sensors refined",
                      r->rounds, r->target.text, r->area.value.value, r->area.value.low,
                      r->area.value.high, orl_verdict_name(r->verdict), r->refined);
}

static int on_year_done(void *ctx, const struct orl_annual_result *result,
                        const struct orl_annual_report *report, json_t *document,
                        const json_t *names, struct orl_error *err)
{
    const struct year *year = ctx;
    (void)names;
    return year->on_result->on_result(year->on_result->ctx, result, report, document, err);
}

int orl_local_annual(struct orl_annual_job *job, const char *folder, const char *output,
                     const char *cache, uint32_t threads,
                     const struct orl_local_distribution *distribution,
                     const struct orl_local_callback *on_result, struct orl_error *err)
{
    struct year year = {.on_result = on_result};
    const struct orl_annual_job_env env = {.run = &year.local.env,
                                           .reuse = cache != NULL,
                                           .round = on_year_round,
                                           .on_result = on_year_done};
    int rc = local_start(&year.local, folder, output, threads, err);
    if (rc)
        return rc;
    set_distribution(&year.local, distribution);
    if (cache) { /* if the folder is missing, the run warns and continues */
        snprintf(year.local.maps.folder, sizeof year.local.maps.folder, "%s", cache);
        orl_make_folder(cache, NULL);
    }
    year.local.env.files_id = "of this run";
    year.local.env.memory_cache = orl_memory_cache_new(YEAR_SHELF);
    rc =
        year.local.env.memory_cache ? orl_annual_job_run(job, &env, err) : orl_error_no_memory(err);
    orl_memory_cache_free(year.local.env.memory_cache);
    local_stop(&year.local);
    return rc;
}

static void on_study_progress(void *ctx, const struct orl_study_step *step)
{
    orl_progress_show_local(ctx, orl_study_step_name(step), step->fraction, step->left_s);
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
                    uint32_t threads, const struct orl_local_distribution *distribution,
                    struct orl_study *ret_study, struct orl_error *err)
{
    const struct orl_files files = orl_raypath_files(folder);
    struct orl_progress_line progress;
    const struct orl_study_env env = {.pool = orl_thread_pool_start(threads),
                                      .files = &files,
                                      .work_folder = output,
                                      .tasks = distribution ? distribution->tasks : NULL,
                                      .store = distribution ? distribution->store : NULL,
                                      .cancel = &interrupted,
                                      .now_s = orl_clock_s,
                                      .progress = on_study_progress,
                                      .point_ready = on_study_point,
                                      .ctx = &progress};
    if (!env.pool)
        return orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
    orl_progress_start(&progress);
    int rc = orl_study_run(request, &env, ret_study, err);
    orl_progress_end(&progress);
    orl_thread_pool_stop(env.pool);
    return rc;
}
