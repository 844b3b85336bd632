/* The lead thread's work: its document, its results, and studies. */

#include "runner/worker/worker_run.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

#include "process/limits.h"
#include "process/times.h"
#include "runner/checkpoints.h"
#include "runner/job_document.h"
#include "store/files/folders.h"
#include "json/decode.h"

/* ---- Studies --------------------------------------------------------------------------------- */

static void on_study_progress(void *ctx, const struct orl_study_step *step)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->job_ppm, (int)(ORL_WORKER_WHOLE * step->fraction));
    orl_worker_set_eta(worker, step->left_s);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.step = *step;
    pthread_mutex_unlock(&worker->news_mutex);
}

static void on_study_point(void *ctx, const struct orl_study_point *point)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    if (worker->progress.n_points < worker->progress.n_settings)
        worker->points[worker->progress.n_points++] = *point;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Runs a study without the map cache, since its measurements must start without maps
 * (oriel/job/study.h). */
static int run_study(struct orl_worker *worker, struct orl_job_request *job_request,
                     const struct orl_files *files, struct orl_error *err)
{
    const struct orl_study_request *request = &job_request->of.study;
    struct orl_study study = {0};
    const struct orl_study_env env = {
        .pool = worker->pool,
        .files = files,
        .work_folder = worker->output,
        .tasks = worker->progress.in_parts ? &worker->distributed.tasks : NULL,
        .store = worker->progress.in_parts ? &worker->distributed.store : NULL,
        .cancel = &worker->cancel,
        .now_s = orl_time_steady_for,
        .progress = on_study_progress,
        .point_ready = on_study_point,
        .spent = orl_worker_add_health,
        .ctx = worker,
    };
    const size_t n_settings = orl_study_count_settings(request);
    struct orl_study_point *points = calloc(n_settings, sizeof *points);
    if (!points)
        return orl_error_no_memory(err);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.points = worker->points = points;
    worker->progress.n_settings = n_settings;
    pthread_mutex_unlock(&worker->news_mutex);
    int rc = orl_study_run(request, &env, &study, err);
    if (rc == 0) {
        rc = orl_study_output_write(&study, request, worker->output, &worker->outcome.summary, err);
        orl_study_done(&study);
    }
    return rc;
}

/* ---- All jobs -------------------------------------------------------------------------------- */

/* Reads the job request from the document. Its main files come from the bundle. */
static int read_document(struct orl_worker *worker, struct orl_job_request *ret_job_request,
                         struct orl_error *err)
{
    struct orl_file file;
    char sha[ORL_SHA_HEX];
    int rc = orl_map_file(worker->spec.document_path, &file, err);
    if (rc)
        return rc;
    orl_sha256_hex(file.data, file.size, sha);
    orl_json_set_cancel(&worker->cancel);
    if (strcmp(sha, worker->spec.document) == 0)
        rc = orl_job_document_read(file.data, file.size, ret_job_request, err);
    else
        rc = orl_error_set(err, ORL_ERR_CORRUPT, "the job's document is damaged in the store");
    orl_json_set_cancel(NULL);
    /* Parsing leaves many small pieces of memory free, so return them to the system. */
    if (file.size > ORL_SERVER_SMALL_JSON)
        malloc_trim(0);
    orl_unmap_file(&file);
    if (rc == 0) {
        rc = orl_job_document_set_scene(ret_job_request, &worker->spec.bundle, err);
        if (rc)
            orl_job_request_done(ret_job_request);
    }
    return rc;
}

/*
 * Returns true if finished parts of a render job are final, so that a restart can use them. Rounds
 * of a job with a goal are not, but its finished skies are.
 */
static bool render_keeps(const struct orl_job_request *job_request)
{
    const struct orl_job *job = &job_request->of.render;
    const bool in_rounds =
        job->goal.relative_error > 0 || job->goal.deadline_s > 0 || job->goal.dgp_error > 0;
    return !in_rounds || job->n_skies > 0;
}

static int run_render(struct orl_worker *worker, struct orl_job_request *job_request,
                      const struct orl_files *files, struct orl_error *err)
{
    const struct orl_job *job = &job_request->of.render;
    return job->n_skies > 0 ? orl_worker_render_skies(worker, job, files, err)
                            : orl_worker_render(worker, job, files, err);
}

static bool annual_keeps(const struct orl_job_request *job_request)
{
    (void)job_request;
    return true;
}

static const struct {
    /* Returns true if finished parts are kept for a restart; NULL: they never are. */
    bool (*keeps_checkpoints)(const struct orl_job_request *job_request);
    int (*run)(struct orl_worker *worker, struct orl_job_request *job_request,
               const struct orl_files *files, struct orl_error *err);
} kinds[ORL_JOB_KIND_COUNT] = {
    [ORL_JOB_KIND_RENDER] = {render_keeps, run_render},
    [ORL_JOB_KIND_STUDY] = {NULL, run_study},
    [ORL_JOB_KIND_ANNUAL] = {annual_keeps, orl_worker_run_annual},
    [ORL_JOB_KIND_BSDF_MAKE] = {NULL, orl_worker_run_bsdf},
    [ORL_JOB_KIND_BSDF_FIT] = {NULL, orl_worker_run_fit},
};

static int make_folder(struct orl_worker *worker, const struct orl_job_request *job_request,
                       struct orl_error *err)
{
    bool (*const keeps)(const struct orl_job_request *) =
        kinds[job_request->kind].keeps_checkpoints;
    worker->keeps_checkpoints = keeps && keeps(job_request);
    const int rc = worker->keeps_checkpoints ? 0 : orl_remove_tree(worker->output, err);
    return rc ? rc : orl_checkpoint_open(worker->output, worker->spec.key, err);
}

static int run_document(struct orl_worker *worker, struct orl_error *err)
{
    struct orl_job_request job_request;
    int rc = read_document(worker, &job_request, err);
    if (rc)
        return rc;
    const struct orl_files files = orl_bundle_provider(&worker->spec.bundle);
    rc = make_folder(worker, &job_request, err);
    if (rc == 0)
        rc = orl_worker_begin_parts(worker, &job_request, err);
    if (rc == 0)
        rc = kinds[job_request.kind].run(worker, &job_request, &files, err);
    orl_worker_end_parts(worker, rc);
    orl_job_request_done(&job_request);
    return rc;
}

/* Moves the work folder to the results. */
static int publish_results(const struct orl_worker *worker, struct orl_error *err)
{
    char final[ORL_PATH_MAX];
    orl_folders_path(worker->spec.folders, final, "results/%s", worker->spec.job_id);
    orl_checkpoint_remove_internal(worker->output);
    int rc = orl_sync_path(worker->output, err);
    /* A crash between the rename and the row's update leaves results of an earlier attempt. */
    if (rc == 0)
        rc = orl_remove_tree(final, err);
    return rc ? rc : orl_rename_synced(worker->output, final, err);
}

/* Publishes the finished results of a cancelled job. If that fails, the job is cancelled without
 * results. */
static void publish_cancelled(struct orl_worker *worker)
{
    if (!worker->outcome.summary || publish_results(worker, NULL) == 0)
        return;
    free(worker->outcome.summary);
    worker->outcome.summary = NULL;
}

int orl_worker_lead(struct orl_worker *worker, struct orl_error *err)
{
    const char *output = worker->output;
    orl_checkpoint_folder(worker->spec.folders, worker->spec.job_id, worker->output);
    orl_job_output_set_cancel(&worker->cancel);
    int rc = run_document(worker, err);
    orl_job_output_set_cancel(NULL);
    if (rc == 0)
        rc = publish_results(worker, err);
    else if (rc == ORL_ERR_CANCELLED)
        publish_cancelled(worker);
    if (rc &&
        !(rc == ORL_ERR_CANCELLED && worker->keeps_checkpoints && atomic_load(&worker->stopped)))
        orl_remove_tree(output, NULL);
    malloc_trim(0);
    return rc;
}
