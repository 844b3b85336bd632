/*
 * oriel run JOB.json -o DIR: runs one job in this process, by the same code as the daemon's
 * workers. DIR gets images and result.json, which is also written on failure.
 */
#include "options/command.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include <oriel/job/run.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/job_file.h"
#include "options/job_options.h"
#include "output/reports.h"
#include "output/sensor_table.h"
#include "result/result_json.h"
#include "json/encode.h"
#include "json/problem.h"

/* Returns result.json for a failed run: the known facts and the error. */
static json_t *failure_to_json(const struct orl_job *job, uint32_t threads,
                               const struct orl_error *err)
{
    const struct orl_result nothing = {.threads = threads, .seed = job->seed};
    const char *state = err->code == ORL_ERR_CANCELLED ? "cancelled" : "failed";
    json_t *json = orl_result_to_json(&nothing, state);
    return orl_json_checked(
        json, json && json_object_set_new(json, "error", orl_problem_from_error(err, NULL)) != 0);
}

static int write_result(const char *output, json_t *json, struct orl_error *err)
{
    char path[4096];
    const int rc = orl_join_path(output, "result.json", path, sizeof path, err);
    return rc ? rc : orl_write_json(path, json, err);
}

/* Prints how far the sums of all sensors are apart, unless the paths are too few to say so. */
static void print_sums(const struct orl_cross_check *check)
{
    static const double most = 0.3; /* half width of a 95 % interval that says something */
    const double error = 1.96 * check->ratio_error;
    if (error <= most)
        fprintf(stderr, ", their sum within %.2g %%", 100 * (fabs(check->ratio - 1) + error));
    else if (isfinite(check->ratio))
        fprintf(stderr, "; too few paths to compare their sum");
}

static void print_cross_check(const struct orl_cross_check *check)
{
    if (check->sensors == 0)
        return;
    fprintf(stderr, "cross-check by path tracing: ");
    if (check->sensors_off > 0)
        fprintf(stderr, "%zu of %zu sensors differ by more than the errors, most likely in the %s",
                check->sensors_off, check->sensors, orl_light_class_name(check->differs_in));
    else
        fprintf(stderr, "agrees at %zu sensor%s", check->sensors, check->sensors == 1 ? "" : "s");
    if (check->sensors_off == 0)
        print_sums(check);
    fprintf(stderr, "\n");
}

/* Prints the table of sensors and the glare of views, then the files, result.json last. */
static void print_summary(const struct orl_result *result, const json_t *json, const char *output)
{
    orl_print_sensor_table(stdout, json);
    orl_print_glare_lines(stdout, json);
    if (result->outcome.asked)
        fprintf(stderr, "accuracy: %s: %s\n", result->outcome.met ? "met" : "not met",
                result->outcome.why);
    print_cross_check(&result->cross_check);
    fprintf(stderr, "seconds:");
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        fprintf(stderr, " %s %.2f", orl_stage_name((enum orl_stage)i), result->timings_s[i]);
    fprintf(stderr, " total %.2f (threads %u)\n", result->total_s, result->threads);
    orl_print_sensor_files(stdout, json, output);
    printf("%s/result.json\n", output);
}

static void print_skies(const json_t *results, const char *output)
{
    const json_t *timings = json_object_get(results, "timings_s");
    fprintf(stderr, "seconds: total %.2f under %zu skies\n",
            json_number_value(json_object_get(timings, "total")),
            json_array_size(json_object_get(results, "skies")));
    printf("%s/result.json\n", output);
}

/* Renders. *ret_json: contents of result.json. */
static int render_job(const struct orl_job *job, const char *folder, const char *output,
                      uint32_t threads, const struct orl_local_distribution *distribution,
                      struct orl_result *ret_result, json_t **ret_json, struct orl_error *err)
{
    if (job->n_skies > 0)
        return orl_local_run_skies(job, folder, output, threads, distribution, ret_json, err);
    int rc = orl_local_run(job, folder, output, threads, distribution, ret_result, err);
    if (rc == 0)
        *ret_json = orl_result_to_json(ret_result, "succeeded");
    return rc;
}

/* Renders likewise, in parts if the command line asks for that. */
static int render_shared(const struct orl_job_file *file, const struct orl_job *job,
                         const struct orl_local_line *line,
                         const struct orl_distributed_options *distributed_options,
                         struct orl_result *ret_result, json_t **ret_json, struct orl_error *err)
{
    struct orl_local_distributed shared;
    if (distributed_options && job->goal.deadline_s > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "a job with a deadline cannot run in parts, because its result "
                             "depends on the machine; request an accuracy instead");
    int rc = orl_local_distributed_open(&shared, distributed_options, file->doc, file->folder,
                                        line->output, line->threads, err);
    if (rc == 0)
        rc = render_job(job, file->folder, line->output, line->threads, shared.distribution,
                        ret_result, ret_json, err);
    orl_local_distributed_done(&shared, rc == 0);
    return rc;
}

/* Runs the document. distributed: NULL if not in parts. */
static int run_document(const struct orl_local_line *line, const struct orl_project_line *project,
                        const struct orl_distributed_options *distributed)
{
    const char *document = line->operand, *output = line->output;
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
    unlink(path); /* a failed start must not leave an earlier run's result */
    rc = orl_job_file_open(document, project, &file, &err);
    if (rc == 0)
        rc = orl_job_file_decode(&file, &job, &err);
    if (rc == 0)
        rc = render_shared(&file, &job, line, distributed, &result, &json, &err);
    if (rc)
        json = failure_to_json(&job, line->threads, &err);
    if (write_result(output, json, &second)) {
        orl_report_error(&second);
        rc = rc ? rc : second.code;
    } else if (rc == 0 && job.n_skies > 0) {
        print_skies(json, output);
    } else if (rc == 0) {
        print_summary(&result, json, output);
    }
    if (err.code)
        orl_report_error(&err);
    json_decref(json);
    orl_result_done(&result);
    orl_job_done(&job);
    orl_job_file_done(&file);
    return rc ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}

int orl_cmd_run(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {.writes = true};
    struct orl_project_line project = {0};
    struct orl_distributed_options distributed = {0};
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for result.json and the images", &line.output, NULL},
        ORL_OPTIONS_MODEL(&project),
        ORL_OPTION_THREADS(&line.threads_text),
        ORL_OPTIONS_DISTRIBUTED(&distributed),
    };
    int code;
    if (!orl_local_parse(self, argc, argv, options, 2 + ORL_MODEL_OPTIONS + ORL_DISTRIBUTED_OPTIONS,
                         &line, &code))
        return code;
    const bool shared = orl_distributed_is_requested(self, &distributed, &code);
    if (code)
        return code;
    /* A year of a project is the same as by `oriel annual`. */
    if (orl_project_line_has_year(&project) && orl_is_project(line.operand))
        return orl_run_project_year(&line, &project, shared ? &distributed : NULL);
    return run_document(&line, &project, shared ? &distributed : NULL);
}
