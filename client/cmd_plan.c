/*
 * oriel plan JOB.json: what `oriel run` would simulate of a job, and why, without rendering. A
 * table, or with --json the result's "plan" and "warnings"; of a job of several skies as many.
 */
#include "command.h"

#include <stdio.h>

#include "job_file.h"
#include "local.h"
#include "plan_table.h"
#include "report.h"
#include "result_json.h"
#include "wrap.h"

static int print_json(const struct orl_result *result, struct orl_error *err)
{
    json_t *json = orl_planned_to_json(result);
    const int failed = !json || json_dumpf(json, stdout, JSON_INDENT(2)) != 0;

    json_decref(json);
    if (failed)
        return orl_error_set(err, ORL_ERR_IO, "the plan cannot be written");
    putchar('\n');
    return 0;
}

static void print_table(const struct orl_result *result)
{
    static const char mark[] = "warning: ";

    orl_plan_print(stdout, &result->plan);
    fflush(stdout); /* before what follows on the other stream */
    for (size_t i = 0; i < result->n_warnings; i++) {
        fputs(mark, stderr);
        orl_print_wrapped(stderr, sizeof mark - 1, sizeof mark - 1, result->warnings[i]);
    }
}

static int plan_one(const struct orl_job *job, const char *folder, uint32_t threads, bool as_json,
                    struct orl_error *err)
{
    struct orl_result result = {0};
    int rc = orl_local_plan(job, folder, threads, &result, err);

    if (rc == 0 && as_json)
        rc = print_json(&result, err);
    else if (rc == 0)
        print_table(&result);
    orl_result_done(&result);
    return rc;
}

/* The plans of a job under each of its skies, one after the other. */
static int plan_skies(struct orl_job *job, const char *folder, uint32_t threads, bool as_json,
                      struct orl_error *err)
{
    struct orl_named_sky *skies = job->skies;
    const struct orl_sky_request none = job->sky;
    const size_t n_skies = job->n_skies;
    int rc = 0;

    job->skies = NULL;
    job->n_skies = 0;
    for (size_t i = 0; i < n_skies && rc == 0; i++) {
        job->sky = skies[i].request;
        if (!as_json)
            printf("%ssky %s\n\n", i ? "\n" : "", skies[i].name);
        rc = plan_one(job, folder, threads, as_json, err);
    }
    job->sky = none;
    job->skies = skies;
    job->n_skies = n_skies;
    return rc;
}

static int plan_document(const char *document, uint32_t threads, bool as_json)
{
    struct orl_job_file file = {0};
    struct orl_job job = {0};
    struct orl_error err = {0};
    int rc = orl_job_file_read(document, &file, &err);

    if (rc == 0)
        rc = orl_job_file_decode(&file, &job, &err);
    if (rc == 0)
        rc = job.n_skies > 0 ? plan_skies(&job, file.folder, threads, as_json, &err)
                             : plan_one(&job, file.folder, threads, as_json, &err);
    orl_job_done(&job);
    orl_job_file_done(&file);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

int orl_cmd_plan(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *threads_text = NULL;
    bool as_json = false;
    const struct orl_option options[] = {
        {.name = "json", .help = "print the plan as JSON", .flag = &as_json},
        {.name = "threads",
         .letter = 'j',
         .metavar = "N",
         .help = "threads to use (default: one per core); the plan does not depend on it",
         .value = &threads_text},
    };
    struct orl_operands operands;
    uint64_t threads = orl_local_cores();
    int code;

    if (!orl_options_parse(self, argc, argv, options, 2, 1, 1, &operands, &code))
        return code;
    code = orl_options_threads(self, threads_text, &threads);
    if (code)
        return code;
    orl_local_catch_interrupts();
    return plan_document(operands.items[0], (uint32_t)threads, as_json);
}
