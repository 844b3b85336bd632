/* A running study: its current run, and its finished points. */
#include <stdlib.h>

#include "process/times.h"
#include "runner/worker/worker_run.h"

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static void on_study_progress(void *ctx, const struct orl_study_step *step)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->job_ppm, (int)(ORL_WORKER_WHOLE * step->fraction));
    orl_worker_set_eta(worker, step->left_s);
    pthread_mutex_lock(&worker->news_mutex);
    worker->step = *step;
    pthread_mutex_unlock(&worker->news_mutex);
}

static void on_study_point(void *ctx, const struct orl_study_point *point)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    if (worker->n_points < worker->n_settings)
        worker->points[worker->n_points++] = *point;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Runs a study without the map cache, since its measurements must start without maps
 * (oriel/job/study.h). */
int orl_worker_run_study(struct orl_worker *worker, struct orl_job_request *job_request,
                         const struct orl_files *files, struct orl_error *err)
{
    const struct orl_study_request *request = &job_request->of.study;
    struct orl_study study = {0};
    const struct orl_study_env env = {
        .pool = worker->pool,
        .files = files,
        .work_folder = worker->output,
        .tasks = worker->in_parts ? &worker->distributed.tasks : NULL,
        .store = worker->in_parts ? &worker->distributed.store : NULL,
        .cancel = &worker->cancel,
        .now_s = now_s,
        .progress = on_study_progress,
        .point_ready = on_study_point,
        .spent = orl_worker_add_health,
        .ctx = worker,
    };
    const size_t n_settings = orl_study_count_settings(request);
    struct orl_study_point *points = calloc(n_settings, sizeof *points);
    if (!points)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    pthread_mutex_lock(&worker->news_mutex);
    worker->points = points;
    worker->n_settings = n_settings;
    pthread_mutex_unlock(&worker->news_mutex);
    int rc = orl_study_run(request, &env, &study, err);
    if (rc == 0) {
        rc = orl_study_output_write(&study, request, worker->output, &worker->outcome.summary, err);
        orl_study_done(&study);
    }
    return rc;
}
