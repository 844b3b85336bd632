/*
 * oriel annual JOB.json|PROJECT -o DIR: computes a year of daylight on grids of sensors, in
 * this process. DIR gets tables, maps, pages and result.json, which is also written on failure.
 */
#include "options/command.h"

#include <stdio.h>
#include <unistd.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/job_file.h"
#include "options/job_options.h"
#include "output/reports.h"
#include "json/problem.h"

/* Output and settings from the command line. */
struct output {
    const char *folder, *cache;
    struct orl_annual_formats formats;
    uint32_t threads;
    const struct orl_distributed_options *distributed; /* NULL: not in parts */
};

/* The job whose result is reported, and the output folder. */
struct result_output {
    const struct orl_annual_job *job;
    const char *folder;
};

/* ---- Results --------------------------------------------------------------------------------- */

/* Prints a line per point: "medium     sunlight by EN 17037, living room: 3.40 h on 2/14". */
static void print_exposure(const struct orl_exposure_request *requested,
                           const struct orl_annual_report *report)
{
    for (size_t i = 0; i < report->n_exposures; i++) {
        const struct orl_exposure *e = &report->exposures[i];
        printf("%-10s sunlight by EN 17037, %s: %.2f h on %d/%d\n",
               orl_exposure_level_name(e->level), requested->points[i].name, e->hours, e->month,
               e->day);
    }
}

/* Prints a line per point and per grid: "minimum    view out by EN 17037, desk: 21.3 degrees,
 * 12 m, sky". */
static void print_views(const struct orl_view_out_request *requested,
                        const struct orl_annual_report *report)
{
    for (size_t i = 0; report->views && i < requested->n_points; i++) {
        const struct orl_view_out *view = &report->views[i];
        printf("%-10s view out by EN 17037, %s: %.4g degrees, %.4g m,%s%s%s\n",
               orl_view_level_name(view->level), requested->points[i].name, view->sight_angle_deg,
               view->distance_m, view->layers & ORL_VIEW_SKY ? " sky" : "",
               view->layers & ORL_VIEW_LANDSCAPE ? " landscape" : "",
               view->layers & ORL_VIEW_GROUND ? " ground" : "");
    }
    for (size_t g = 0; report->view_shares && g < report->n_grids; g++) {
        const struct orl_view_shares *shares = &report->view_shares[g];
        printf("%-10s view out by EN 17037, %s: %.4g %% minimum, %.4g %% medium, %.4g %% high\n",
               orl_view_level_name(shares->level), report->grids[g].name, shares->percent[0],
               shares->percent[1], shares->percent[2]);
    }
}

/* Prints a line per viewpoint: "medium     glare by EN 17037, desk: DGP above 0.380 [0.375, 0.384]
 * in 5 % of use". */
static void print_glare(const struct orl_viewpoint_request *requested,
                        const struct orl_annual_report *report)
{
    for (size_t i = 0; i < report->n_viewpoints; i++) {
        const struct orl_viewpoint_glare *viewpoint = &report->viewpoints[i];
        printf("%-10s glare by EN 17037, %s: DGP above %.3f [%.3f, %.3f] in 5 %% of use\n",
               viewpoint->lowest == viewpoint->highest ? orl_glare_protection_name(viewpoint->level)
                                                       : "undecided",
               requested->viewpoints[i].name, viewpoint->exceeded.value, viewpoint->exceeded.low,
               viewpoint->exceeded.high);
    }
}

static void print_reuse(const struct orl_annual_result *result)
{
    if (!result->reuse.asked)
        return;
    fprintf(stderr, "cache:");
    for (int i = 0; i < ORL_ANNUAL_CACHE_KINDS; i++) {
        const struct orl_annual_cache_stats *r = &result->reuse.of[i];
        fprintf(stderr, "%s %s: %llu found, ", i > 0 ? ";" : "",
                orl_annual_cache_kind_name((enum orl_annual_cache_kind)i),
                (unsigned long long)r->found);
        if (r->topped_up > 0)
            fprintf(stderr, "%llu with fewer samples, ", (unsigned long long)r->topped_up);
        fprintf(stderr, "%llu made", (unsigned long long)r->made);
    }
    fprintf(stderr, "; rays saved: %llu\n",
            (unsigned long long)result->reuse.of[ORL_ANNUAL_CACHE_PATHS].rays_saved);
}

static void print_summary(const struct orl_annual_result *result,
                          const struct orl_annual_report *report, const json_t *document,
                          const struct result_output *result_output)
{
    orl_print_verdicts(stdout, json_object_get(document, "verdicts"));
    print_exposure(&result_output->job->report_request.exposure, report);
    print_views(&result_output->job->report_request.view_out, report);
    print_glare(&result_output->job->report_request.glare, report);
    print_reuse(result);
    fprintf(stderr, "seconds:");
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        fprintf(stderr, " %s %.2f", orl_annual_stage_name((enum orl_annual_stage)i),
                result->timings_s[i]);
    fprintf(stderr, " total %.2f (threads %u)\n", result->total_s, result->threads);
    printf("%s/result.json\n", result_output->folder);
}

static int write_result(const char *output, const json_t *json, struct orl_error *err)
{
    char path[4096];
    const int rc = orl_join_path(output, "result.json", path, sizeof path, err);
    return rc ? rc : orl_write_json(path, json, err);
}

/* Writes result.json and prints the summary. ctx: a struct result_output. */
static int on_result(void *ctx, const struct orl_annual_result *result,
                     const struct orl_annual_report *report, json_t *document,
                     struct orl_error *err)
{
    const struct result_output *result_output = ctx;
    const int rc = write_result(result_output->folder, document, err);
    if (rc == 0)
        print_summary(result, report, document, result_output);
    return rc;
}

/* ---- The run --------------------------------------------------------------------------------- */

static void write_failure(const char *output, const struct orl_error *err)
{
    struct orl_error second = {0};
    json_t *json = json_pack("{s:s, s:s, s:o}", "kind", "annual", "state",
                             err->code == ORL_ERR_CANCELLED ? "cancelled" : "failed", "error",
                             orl_problem_from_error(err, NULL));
    if (write_result(output, json, &second))
        orl_report_error(&second);
    json_decref(json);
    orl_report_error(err);
}

static int decode_annual(const struct orl_job_file *file, struct orl_annual_job *ret_job,
                         struct orl_error *err)
{
    const int rc = orl_annual_job_from_json(file->doc, ORL_JOB_LOCAL, ret_job, NULL, err);
    if (rc)
        orl_error_at(err, file->path, 0, NULL);
    return rc;
}

/* Runs the year, in parts if the command line asks for that. */
static int run_year(struct orl_annual_job *job, const struct orl_job_file *file,
                    const struct output *output, const struct orl_local_callback *callback,
                    struct orl_error *err)
{
    struct orl_local_distributed shared;
    int rc = orl_local_distributed_open(&shared, output->distributed, file->doc, file->folder,
                                        output->folder, output->threads, err);
    if (rc == 0)
        rc = orl_local_annual(job, file->folder, output->folder, output->cache, output->threads,
                              shared.distribution, callback, err);
    orl_local_distributed_done(&shared, rc == 0);
    return rc;
}

/* Opens the document or project. A project needs a weather file from the command line. */
static int open_document(const char *path, const struct orl_project_line *project,
                         struct orl_job_file *ret_file, struct orl_error *err)
{
    if (!orl_is_project(path) || project->weather)
        return orl_job_file_open(path, project, ret_file, err);
    *ret_file = (struct orl_job_file){.path = path};
    orl_error_set(err, ORL_ERR_INVALID, "a year of a project needs its weather");
    orl_error_hint(err, "give --weather FILE.epw");
    return ORL_ERR_INVALID;
}

static int run_document(const char *document, const struct orl_project_line *project,
                        const struct output *output)
{
    struct orl_job_file file = {0};
    struct orl_annual_job job = {0};
    struct orl_error err = {0};
    char path[4096];
    struct result_output result_output = {&job, output->folder};
    const struct orl_local_callback callback = {on_result, &result_output};
    int rc = orl_make_folder(output->folder, &err);
    if (rc == 0)
        rc = orl_join_path(output->folder, "result.json", path, sizeof path, &err);
    if (rc)
        return orl_report_error(&err);
    unlink(path); /* a failed start must not leave an earlier run's result */
    rc = open_document(document, project, &file, &err);
    if (rc == 0)
        rc = decode_annual(&file, &job, &err);
    job.formats.honeybee = job.formats.honeybee || output->formats.honeybee;
    job.formats.matrices = job.formats.matrices || output->formats.matrices;
    job.formats.phases = job.formats.phases || output->formats.phases;
    if (rc == 0)
        rc = run_year(&job, &file, output, &callback, &err);
    if (rc)
        write_failure(output->folder, &err);
    orl_annual_job_done(&job);
    orl_job_file_done(&file);
    return rc ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}

int orl_run_project_year(const struct orl_local_line *line, const struct orl_project_line *project,
                         const struct orl_distributed_options *distributed)
{
    const struct output output = {
        .folder = line->output, .threads = line->threads, .distributed = distributed};
    return run_document(line->operand, project, &output);
}

int orl_cmd_annual(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {.writes = true};
    struct output output = {0};
    struct orl_distributed_options distributed = {0};
    struct orl_project_line project = {0};
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for result.json, tables, maps and pages", &line.output,
         NULL},
        {"cache", 0, "DIR", "folder of paths for later runs: another weather file, or more samples",
         &output.cache, NULL},
        {"honeybee", 0, NULL, "write all hours as Honeybee's results folder, DIR/results", NULL,
         &output.formats.honeybee},
        {"ill", 0, NULL, "write all lit hours as Radiance matrices, DIR/GRID.ill", NULL,
         &output.formats.matrices},
        {"phases", 0, NULL, "write matrices of the three and five phases for dctimestep", NULL,
         &output.formats.phases},
        ORL_OPTIONS_MODEL(&project),
        ORL_OPTION_THREADS(&line.threads_text),
        ORL_OPTIONS_DISTRIBUTED(&distributed),
    };
    int code;
    if (!orl_local_parse(self, argc, argv, options, 6 + ORL_MODEL_OPTIONS + ORL_DISTRIBUTED_OPTIONS,
                         &line, &code))
        return code;
    output.folder = line.output;
    output.threads = line.threads;
    output.distributed =
        orl_distributed_is_requested(self, &distributed, &code) ? &distributed : NULL;
    if (output.distributed && output.cache)
        code = orl_usage_error(self, "--cache cannot be combined with --parts or --slurm");
    return code ? code : run_document(line.operand, &project, &output);
}
