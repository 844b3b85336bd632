/*
 * oriel study STUDY.json --output DIR: measures accuracy against time, on one scene. Writes
 * study.json, study.csv, study.svg and study.png in DIR, and prints the points as a table.
 */
#include "options/command.h"

#include <stdio.h>
#include <unistd.h>

#include <oriel/job/study.h>

#include "chart/charts.h"
#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/job_file.h"
#include "job/study_json.h"
#include "options/job_options.h"
#include "output/reports.h"

static const char *const file_names[] = {"study.json", "study.csv", "study.svg", "study.png"};
enum { FILE_COUNT = sizeof file_names / sizeof *file_names };

/* Removes files of an earlier study when a new one starts. */
static int clear_output(const char *output, char paths[FILE_COUNT][4096], struct orl_error *err)
{
    int rc = orl_make_folder(output, err);
    for (int i = 0; i < FILE_COUNT && rc == 0; i++) {
        rc = orl_join_path(output, file_names[i], paths[i], sizeof paths[i], err);
        if (rc == 0)
            unlink(paths[i]);
    }
    return rc;
}

/* Decodes the document; errors name its file. */
static int decode_study(const struct orl_job_file *file, struct orl_study_request *ret_request,
                        struct orl_error *err)
{
    struct orl_study_request request;
    int rc = orl_study_from_json(file->doc, ORL_JOB_LOCAL, &request, NULL, err);
    if (rc == 0) {
        rc = orl_study_request_validate(&request, err);
        if (rc)
            orl_study_request_done(&request);
    }
    if (rc) {
        orl_error_at(err, file->path, 0, NULL);
        return rc;
    }
    *ret_request = request;
    return 0;
}

static int write_files(const struct orl_study *study, const struct orl_study_request *request,
                       char paths[FILE_COUNT][4096], struct orl_error *err)
{
    json_t *json = orl_study_to_json(study, request);
    int rc = orl_write_json(paths[0], json, err);
    json_decref(json);
    if (rc == 0)
        rc = orl_study_write_csv(study, paths[1], err);
    if (rc == 0)
        rc = orl_study_chart_write(study, request->title, ORL_CANVAS_SVG, paths[2], err);
    if (rc == 0)
        rc = orl_study_chart_write(study, request->title, ORL_CANVAS_PNG, paths[3], err);
    return rc;
}

static void print_summary(const struct orl_study *study, char paths[FILE_COUNT][4096])
{
    for (size_t i = 0; i < study->n_warnings; i++)
        fprintf(stderr, "warning: %s\n", study->warnings[i]);
    orl_study_print(stdout, study);
    printf("\n");
    for (int i = 0; i < FILE_COUNT; i++)
        printf("%s\n", paths[i]);
}

/* Runs the study, in parts if the command line asks for that. */
static int run_study(const struct orl_study_request *request, const struct orl_job_file *file,
                     const struct orl_local_line *line,
                     const struct orl_distributed_options *distributed, struct orl_study *ret_study,
                     struct orl_error *err)
{
    struct orl_local_distributed shared;
    int rc = orl_local_distributed_open(&shared, distributed, file->doc, file->folder, line->output,
                                        line->threads, err);
    if (rc == 0)
        rc = orl_local_study(request, file->folder, line->output, line->threads,
                             shared.distribution, ret_study, err);
    orl_local_distributed_done(&shared, rc == 0);
    return rc;
}

/* Runs the document. distributed: NULL if not in parts. */
static int run_document(const struct orl_local_line *line,
                        const struct orl_distributed_options *distributed)
{
    struct orl_job_file file = {0};
    struct orl_study_request request = {0};
    struct orl_study study = {0};
    struct orl_error err = {0};
    char paths[FILE_COUNT][4096];
    int rc = clear_output(line->output, paths, &err);
    if (rc == 0)
        rc = orl_job_file_read(line->operand, &file, &err);
    if (rc == 0)
        rc = decode_study(&file, &request, &err);
    if (rc == 0)
        rc = run_study(&request, &file, line, distributed, &study, &err);
    if (rc == 0)
        rc = write_files(&study, &request, paths, &err);
    if (rc == 0)
        print_summary(&study, paths);
    else
        orl_report_error(&err);
    orl_study_done(&study);
    orl_study_request_done(&request);
    orl_job_file_done(&file);
    return rc ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}

int orl_cmd_study(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {.threads = 1, .writes = true};
    struct orl_distributed_options distributed = {0};
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for the study's files", &line.output, NULL},
        {"threads", 'j', "N",
         "threads of every run (default: 1); times depend on it, errors do not", &line.threads_text,
         NULL},
        ORL_OPTIONS_DISTRIBUTED(&distributed),
    };
    int code;
    if (!orl_local_parse(self, argc, argv, options, 2 + ORL_DISTRIBUTED_OPTIONS, &line, &code))
        return code;
    const bool shared = orl_distributed_is_requested(self, &distributed, &code);
    return code ? code : run_document(&line, shared ? &distributed : NULL);
}
