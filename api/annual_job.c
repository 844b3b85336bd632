#include "annual_job.h"

#include <stdlib.h>

#include "annual_files.h"

/* State of a running job. */
struct running {
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
    struct orl_annual_phases phases;
};

/* ---- The year -------------------------------------------------------------------------------- */

/* Checks the wishes against the loaded year before rendering begins. */
static int on_begins(void *ctx, const struct orl_annual_result *result, struct orl_error *err)
{
    const struct running *r = ctx;
    return orl_annual_wishes_check(&r->job->request, result, &r->job->wishes, r->run.files, err);
}

static bool on_kept(void *ctx, struct orl_annual_block *block)
{
    const struct running *r = ctx;
    return r->env->kept && r->env->kept(r->env->run->ctx, block);
}

static void on_done(void *ctx, const struct orl_annual_block *block)
{
    const struct running *r = ctx;
    if (r->env->done)
        r->env->done(r->env->run->ctx, block);
}

/* Returns the year's fraction of the job's time. A seat takes about as long as 128 sensors. */
static double year_part(const struct orl_annual_job *job)
{
    static const double sensors_a_seat = 128;
    const double n = (double)job->request.n_sensors;
    const double all = n + sensors_a_seat * (double)job->wishes.glare.n_seats;
    return ORL_ANNUAL_FILES_FROM * n / all;
}

static int run_year(struct running *r, struct orl_error *err)
{
    struct orl_run_env run = r->run;
    const struct orl_annual_env env = {.run = &run,
                                       .begins = on_begins,
                                       .reuse = r->env->reuse,
                                       .reuse_most = r->env->reuse_most,
                                       .kept = on_kept,
                                       .done = on_done,
                                       .ctx = r};
    run.part = year_part(r->job);
    return orl_annual_run_until(&r->job->request, &r->job->wishes, &env, r->env->round, run.ctx,
                                &r->result, &r->refinement, err);
}

/* Evaluates view out before the year, so that wrong names fail before the long work begins. */
static int evaluate_view_out(struct running *r, struct orl_error *err)
{
    const struct orl_view_out_wish *wish = &r->job->wishes.view_out;
    if (!orl_view_out_is_wished(wish))
        return 0;
    r->n_views = orl_view_out_places(wish, &r->job->request);
    r->views = calloc(r->n_views + 1, sizeof *r->views);
    if (!r->views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return orl_view_out_find(wish, &r->job->request, &r->run, r->views, err);
}

/* Notes the scene files as inputs also when the scene came from the in-memory cache. */
static int note_scene(struct running *r, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < r->result.n_scene_read && rc == 0; i++)
        rc = orl_annual_inputs_need(&r->inputs, r->result.scene_read[i], err);
    return rc;
}

/* ---- Report and files ------------------------------------------------------------------------ */

static int evaluate_glare(struct running *r, struct orl_error *err)
{
    struct orl_run_env run = r->run;
    run.part_from = year_part(r->job);
    run.part = ORL_ANNUAL_FILES_FROM - run.part_from;
    return orl_annual_report_dazzle(&r->job->request, &r->result, &r->job->wishes, &run, &r->report,
                                    err);
}

static int make_report(struct running *r, struct orl_error *err)
{
    const struct orl_run_env *run = &r->run;
    int rc = orl_annual_report_make(&r->job->request, &r->result, &r->job->wishes, run->files,
                                    run->cancel, run->crew, &r->report, err);
    if (rc == 0)
        rc = orl_annual_report_expose(&r->job->request, &r->result, &r->job->wishes, run,
                                      &r->report, err);
    if (rc == 0)
        rc = evaluate_glare(r, err);
    if (rc == 0 && r->views) {
        rc = orl_annual_report_view(&r->job->wishes, r->views, r->n_views, &r->report, err);
        r->views = NULL;
    }
    return rc ? rc
              : orl_annual_report_warn(&r->job->request, &r->report, &r->result, run->warned,
                                       run->ctx, err);
}

static int write_and_report(struct running *r, struct orl_error *err)
{
    const struct orl_annual_told told = {r->job, &r->run, &r->result, &r->report,
                                         r->job->formats.phases ? &r->phases : NULL};
    json_t *names = json_array(), *document = NULL;
    int rc = names ? orl_annual_files_write(&told, names, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0) {
        document = orl_annual_report_to_json(r->job, &r->result, &r->refinement, &r->report,
                                             &r->inputs, names);
        rc = document ? r->env->tell(r->env->run->ctx, &r->result, &r->report, document, names, err)
                      : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    json_decref(document);
    json_decref(names);
    return rc;
}

int orl_annual_job_run(struct orl_annual_job *job, const struct orl_annual_job_env *env,
                       struct orl_error *err)
{
    struct running r = {.job = job, .env = env, .run = *env->run};
    r.files = orl_annual_inputs_of(&r.inputs, env->run->files);
    r.run.files = &r.files;
    int rc = orl_annual_grids_read(&job->request, job->grid_files, &r.files, r.run.cancel, err);
    if (rc == 0)
        rc = orl_annual_schedules_read(&job->request, &r.files, err);
    if (rc == 0)
        rc = orl_annual_validate(&job->request, err);
    if (rc == 0)
        rc = evaluate_view_out(&r, err);
    if (rc == 0 && job->formats.phases)
        rc = orl_annual_phases_find(&job->request, &r.run, &r.phases, err);
    if (rc == 0)
        rc = run_year(&r, err);
    if (rc == 0)
        rc = note_scene(&r, err);
    if (rc == 0)
        rc = make_report(&r, err);
    if (rc == 0)
        rc = write_and_report(&r, err);
    free(r.views);
    orl_annual_phases_done(&r.phases);
    orl_annual_report_done(&r.report);
    orl_annual_done(&r.result);
    orl_annual_inputs_done(&r.inputs);
    return rc;
}
