/*
 * oriel run JOB.json -o DIR: one job, in this process, the same code path that the daemon's workers
 * take. DIR/result.json says how it went, also when it failed; images lie beside it.
 */
#include "command.h"

#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <oriel/run.h>

#include "files.h"
#include "follow.h"
#include "job_file.h"
#include "problem.h"
#include "progress.h"
#include "report.h"
#include "result_json.h"

/* The one variable outside a function: a signal handler has no other way to say anything. */
static atomic_bool interrupted;

static void on_interrupt(int number)
{
    atomic_store(&interrupted, true);
    signal(number, SIG_DFL); /* a second Ctrl-C ends the program at once */
}

static void catch_interrupts(void)
{
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = SA_RESTART};

    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* The processors this process may use: fewer than there are, under taskset or in a container. */
static uint32_t usable_cores(void)
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

/* Runs a decoded job with the folder of its document for files. */
static int run_job(const struct orl_job *job, const char *folder, const char *output,
                   uint32_t threads, struct orl_result *ret_result, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_folder_store maps;
    struct orl_map_store store = orl_map_store_in_folder(&maps);
    struct orl_progress progress;
    struct orl_run_env env = {.files = &files,
                              .store = &store,
                              .output_folder = output,
                              .cancel = &interrupted,
                              .now_s = orl_clock_s,
                              .progress = on_progress,
                              .map_ready = on_map,
                              .ctx = &progress};
    int rc = orl_join_path(output, "maps", maps.folder, sizeof maps.folder, err);

    if (rc)
        return rc;
    env.crew = orl_crew_start(threads);
    if (!env.crew)
        return orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
    orl_progress_start(&progress);
    rc = orl_run(job, &env, ret_result, err);
    orl_progress_end(&progress);
    orl_crew_stop(env.crew);
    return rc;
}

/* result.json for a run that went wrong: what is known, and why. */
static json_t *failure_to_json(const struct orl_job *job, uint32_t threads,
                               const struct orl_error *err)
{
    const struct orl_result nothing = {.threads = threads, .seed = job->seed};
    const char *state = err->code == ORL_ERR_CANCELLED ? "cancelled" : "failed";
    json_t *json = orl_result_to_json(&nothing, state);

    if (json && json_object_set_new(json, "error", orl_problem_from_error(err, NULL)) != 0) {
        json_decref(json);
        return NULL;
    }
    return json;
}

static int write_result(const char *output, json_t *json, struct orl_error *err)
{
    char path[4096];
    int rc;

    if (!json)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    rc = orl_join_path(output, "result.json", path, sizeof path, err);
    return rc ? rc : orl_write_json(path, json, err);
}

static void print_summary(const struct orl_result *result, const char *output)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        fprintf(stderr, "warning: %s\n", result->warnings[i]);
    fprintf(stderr, "seconds:");
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        fprintf(stderr, " %s %.2f", orl_stage_name((enum orl_stage)i), result->timings_s[i]);
    fprintf(stderr, " total %.2f (threads %u)\n", result->total_s, result->threads);
    printf("%s/result.json\n", output);
}

/* The whole of it, once the command line is understood. */
static int run_document(const char *document, const char *output, uint32_t threads)
{
    struct orl_job_file file = {0};
    struct orl_job job = {0};
    struct orl_result result = {0};
    struct orl_error err = {0}, second = {0};
    json_t *json = NULL;
    char path[4096];
    int rc = orl_make_folder(output, &err);

    if (rc == 0)
        rc = orl_join_path(output, "result.json", path, sizeof path, &err);
    if (rc)
        return orl_report_error(&err);
    unlink(path); /* an earlier run's success must not outlive this one's start */
    rc = orl_job_file_read(document, &file, &err);
    if (rc == 0)
        rc = orl_job_file_decode(&file, &job, &err);
    if (rc == 0)
        rc = run_job(&job, file.folder, output, threads, &result, &err);
    json = rc ? failure_to_json(&job, threads, &err) : orl_result_to_json(&result, "succeeded");
    if (write_result(output, json, &second)) {
        orl_report_error(&second);
        rc = rc ? rc : second.code;
    } else if (rc == 0) {
        print_summary(&result, output);
    }
    if (err.code)
        orl_report_error(&err);
    json_decref(json);
    orl_result_done(&result);
    orl_job_done(&job);
    orl_job_file_done(&file);
    return rc ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}

int orl_cmd_run(const struct orl_command *self, int argc, char **argv)
{
    const char *output = NULL, *threads_text = NULL;
    const struct orl_option options[] = {
        {.name = "output",
         .letter = 'o',
         .metavar = "DIR",
         .help = "where result.json and the images go",
         .value = &output},
        {.name = "threads",
         .letter = 'j',
         .metavar = "N",
         .help = "threads to use (default: one per core); results do not depend on it",
         .value = &threads_text},
    };
    struct orl_operands operands;
    uint64_t threads = usable_cores();
    int code;

    if (!orl_options_parse(self, argc, argv, options, 2, 1, 1, &operands, &code))
        return code;
    if (!output)
        return orl_usage_error(self, "-o DIR is missing");
    if (threads_text && !orl_parse_count(threads_text, 1, 1024, &threads))
        return orl_usage_error(self, "--threads takes a number from 1 to 1024, not \"%s\"",
                               threads_text);
    catch_interrupts();
    return run_document(operands.items[0], output, (uint32_t)threads);
}
