/*
 * oriel plan JOB.json: prints what `oriel run` would simulate, and why, without rendering. It
 * prints a table and the estimated time for each accuracy, or with --json the result's "plan",
 * "warnings" and "curve". A job of several skies has one plan per sky.
 */
#include "options/command.h"

#include <stdio.h>
#include <string.h>

#include "commands/local.h"
#include "http/json_get.h"
#include "input/job_file.h"
#include "job/job_request_json.h"
#include "output/reports.h"
#include "output/terminal.h"
#include "result/result_json.h"

static void print_table(const struct orl_result *result, const struct orl_accuracy_curve *curve)
{
    static const char mark[] = "warning: ";
    orl_plan_print(stdout, &result->plan);
    if (curve)
        orl_curve_print(stdout, curve);
    for (size_t i = 0; i < result->n_warnings; i++) {
        fputs(mark, stderr);
        orl_print_wrapped(stderr, ORL_WRAP_COLUMNS, sizeof mark - 1, sizeof mark - 1,
                          result->warnings[i]);
    }
}

/* The output format, and true if a plan was printed. */
struct plans {
    bool as_json, begun;
};

static int print_plan(void *ctx, const char *sky, const struct orl_result *planned,
                      const struct orl_accuracy_curve *curve, struct orl_error *err)
{
    struct plans *plans = ctx;
    if (plans->as_json)
        return orl_print_json(orl_planned_to_json(planned, curve), 0, err);
    if (sky)
        printf("%ssky %s\n\n", plans->begun ? "\n" : "", sky);
    plans->begun = true;
    print_table(planned, curve);
    return 0;
}

/* Refuses years: only render jobs have plans. */
static int refuse_years(const struct orl_job_file *file, struct orl_error *err)
{
    if (strcmp(orl_get_text(file->doc, "kind"), orl_job_request_kind_name(ORL_JOB_KIND_ANNUAL)) !=
        0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "kind: a year (\"annual\") has no plan");
    orl_error_at(err, file->path, 0, NULL);
    orl_error_hint(err, "only jobs of kind \"render\" have plans; `oriel annual` runs a year");
    return ORL_ERR_INVALID;
}

static int plan_document(const char *document, const struct orl_project_line *project,
                         uint32_t threads, bool as_json)
{
    struct plans plans = {.as_json = as_json};
    struct orl_job_file file = {0};
    struct orl_job job = {0};
    struct orl_error err = {0};
    int rc = orl_job_file_open(document, project, &file, &err);
    if (rc == 0)
        rc = refuse_years(&file, &err);
    if (rc == 0)
        rc = orl_job_file_decode(&file, &job, &err);
    if (rc == 0)
        rc = orl_local_plan(&job, file.folder, threads, print_plan, &plans, &err);
    orl_job_done(&job);
    orl_job_file_done(&file);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

int orl_cmd_plan(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {0};
    struct orl_project_line project = {0};
    bool as_json = false;
    const struct orl_option options[] = {
        {"json", 0, NULL, "print the plan as JSON", NULL, &as_json},
        ORL_OPTIONS_PROJECT(&project),
        ORL_OPTION_THREADS(&line.threads_text),
    };
    int code;
    if (!orl_local_parse(self, argc, argv, options, 4, &line, &code))
        return code;
    return plan_document(line.operand, &project, line.threads, as_json);
}
