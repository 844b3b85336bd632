#include "annual_job/annual_job.h"

#include <stdlib.h>

/* State of a running job. */
struct annual_run {
    struct orl_annual_job *job;
    const struct orl_annual_job_env *env;
    struct orl_annual_inputs inputs;
    struct orl_files files; /* the run's files, wrapped so that every opened file is noted */
    struct orl_run_env run; /* env's environment, with these files */
    struct orl_annual_result result;
    struct orl_annual_refinement refinement;
    struct orl_annual_report report;
    struct orl_view_out *views; /* until moved into the report */
    size_t n_views;
    struct orl_phase_matrices phases;
};

/* ---- The year -------------------------------------------------------------------------------- */

/* Checks the report request against the loaded year before rendering begins. */
static int on_begins(void *ctx, const struct orl_annual_result *result, struct orl_error *err)
{
    const struct annual_run *r = ctx;
    return orl_report_request_check(&r->job->request, result, &r->job->report_request, r->run.files,
                                    err);
}

static bool on_kept(void *ctx, struct orl_annual_chunk *chunk)
{
    const struct annual_run *r = ctx;
    return r->env->restored && r->env->restored(r->env->run->ctx, chunk);
}

static void on_done(void *ctx, const struct orl_annual_chunk *chunk)
{
    const struct annual_run *r = ctx;
    if (r->env->done)
        r->env->done(r->env->run->ctx, chunk);
}

/* Returns the year's fraction of the job's time. A viewpoint takes about as long as 128 sensors. */
static double render_fraction(const struct orl_annual_job *job)
{
    static const double sensors_per_viewpoint = 128;
    const double n = (double)job->request.n_sensors;
    const double all = n + sensors_per_viewpoint * (double)job->report_request.glare.n_viewpoints;
    return ORL_ANNUAL_FILES_FROM * n / all;
}

static int run_year(struct annual_run *r, struct orl_error *err)
{
    struct orl_run_env run = r->run;
    const struct orl_annual_env env = {.run = &run,
                                       .begins = on_begins,
                                       .reuse = r->env->reuse,
                                       .reuse_most = r->env->reuse_most,
                                       .restored = on_kept,
                                       .done = on_done,
                                       .ctx = r};
    run.part = render_fraction(r->job);
    return orl_annual_run_until(&r->job->request, &r->job->report_request, &env, r->env->round,
                                run.ctx, &r->result, &r->refinement, err);
}

/* Evaluates view out before the year, so that wrong names fail before the long work begins. */
static int evaluate_view_out(struct annual_run *r, struct orl_error *err)
{
    const struct orl_view_out_request *view_out_request = &r->job->report_request.view_out;
    if (!orl_view_out_is_requested(view_out_request))
        return 0;
    r->n_views = orl_view_out_count(view_out_request, &r->job->request);
    r->views = calloc(r->n_views + 1, sizeof *r->views);
    if (!r->views)
        return orl_error_no_memory(err);
    return orl_view_out_compute(view_out_request, &r->job->request, &r->run, r->views, err);
}

/* Notes the scene files as inputs also when the scene came from the in-memory cache. */
static int add_scene_inputs(struct annual_run *r, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < r->result.n_scene_read && rc == 0; i++)
        rc = orl_annual_inputs_ensure(&r->inputs, r->result.scene_read[i], err);
    return rc;
}

/* ---- Report and files ------------------------------------------------------------------------ */

static int evaluate_glare(struct annual_run *r, struct orl_error *err)
{
    struct orl_run_env run = r->run;
    run.part_from = render_fraction(r->job);
    run.part = ORL_ANNUAL_FILES_FROM - run.part_from;
    return orl_annual_report_add_glare(&r->job->request, &r->result, &r->job->report_request, &run,
                                       &r->report, err);
}

static int make_report(struct annual_run *r, struct orl_error *err)
{
    const struct orl_run_env *run = &r->run;
    int rc = orl_annual_report_make(&r->job->request, &r->result, &r->job->report_request,
                                    run->files, run->cancel, run->pool, &r->report, err);
    if (rc == 0)
        rc = orl_annual_report_add_exposure(&r->job->request, &r->result, &r->job->report_request,
                                            run, &r->report, err);
    if (rc == 0)
        rc = evaluate_glare(r, err);
    if (rc == 0 && r->views) {
        rc = orl_annual_report_add_views(&r->job->report_request, r->views, r->n_views, &r->report,
                                         err);
        r->views = NULL;
    }
    return rc ? rc
              : orl_annual_report_warn(&r->job->request, &r->report, &r->result, run->warned,
                                       run->ctx, err);
}

static int write_and_report(struct annual_run *r, struct orl_error *err)
{
    const struct orl_annual_outputs outputs = {r->job, &r->run, &r->result, &r->report,
                                               r->job->formats.phases ? &r->phases : NULL};
    json_t *names = json_array(), *document = NULL;
    int rc = names ? orl_annual_files_write(&outputs, names, err) : orl_error_no_memory(err);
    if (rc == 0) {
        document = orl_annual_report_to_json(r->job, &r->result, &r->refinement, &r->report,
                                             &r->inputs, names);
        rc = document
                 ? r->env->on_result(r->env->run->ctx, &r->result, &r->report, document, names, err)
                 : orl_error_no_memory(err);
    }
    json_decref(document);
    json_decref(names);
    return rc;
}

int orl_annual_job_run(struct orl_annual_job *job, const struct orl_annual_job_env *env,
                       struct orl_error *err)
{
    struct annual_run r = {.job = job, .env = env, .run = *env->run};
    r.files = orl_annual_inputs_provider(&r.inputs, env->run->files);
    r.run.files = &r.files;
    int rc = orl_annual_grids_read(&job->request, job->grid_files, &r.files, r.run.cancel, err);
    if (rc == 0)
        rc = orl_annual_schedules_read(&job->request, &r.files, err);
    if (rc == 0)
        rc = orl_annual_validate(&job->request, err);
    if (rc == 0)
        rc = evaluate_view_out(&r, err);
    if (rc == 0 && job->formats.phases)
        rc = orl_phase_matrices_compute(&job->request, &r.run, &r.phases, err);
    if (rc == 0)
        rc = run_year(&r, err);
    if (rc == 0)
        rc = add_scene_inputs(&r, err);
    if (rc == 0)
        rc = make_report(&r, err);
    if (rc == 0)
        rc = write_and_report(&r, err);
    free(r.views);
    orl_phase_matrices_done(&r.phases);
    orl_annual_report_done(&r.report);
    orl_annual_done(&r.result);
    orl_annual_inputs_done(&r.inputs);
    return rc;
}
