#include "runner/worker/worker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "health/crash.h"
#include "process/times.h"
#include "runner/worker/worker_run.h"

enum { RENDER_NICE = 10 };

/* One libuv work, which runs one thread of the job's thread pool. */
struct orl_worker_member {
    uv_work_t work;
    struct orl_worker *worker;
    uint32_t index;
};

static void member_work(uv_work_t *work)
{
    struct orl_worker_member *member = work->data;
    struct orl_worker *worker = member->worker;
    /* Lowers the priority of this thread alone (Linux), unless the daemon runs at a lower one. It
     * cannot be raised again without privileges. That is acceptable: no work of the pool should run
     * before the loop. */
    if (getpriority(PRIO_PROCESS, (id_t)gettid()) < RENDER_NICE)
        setpriority(PRIO_PROCESS, (id_t)gettid(), RENDER_NICE);
    orl_crash_record_begin_job(worker->spec.job_id);
    if (member->index > 0) {
        orl_thread_pool_work(worker->pool, member->index);
    } else {
        worker->outcome.code = orl_worker_lead(worker, &worker->outcome.err);
        orl_thread_pool_dismiss(worker->pool);
    }
    orl_crash_record_end_job();
}

static void worker_free(struct orl_worker *worker)
{
    if (!worker)
        return;
    orl_bundle_done(&worker->spec.bundle);
    orl_thread_pool_free(worker->pool);
    pthread_mutex_destroy(&worker->news_mutex);
    free(worker->members);
    for (size_t i = 0; i < worker->progress.n_warnings; i++)
        free(worker->warnings[i]);
    free(worker->points);
    free(worker->news);
    free(worker->results);
    free(worker);
}

static void member_back(uv_work_t *work, int status)
{
    (void)status; /* works are never cancelled: the lead must dismiss the thread pool */
    struct orl_worker *worker = ((struct orl_worker_member *)work->data)->worker;
    if (--worker->queued > 0)
        return;
    worker->spec.done(worker->spec.ctx, &worker->outcome);
    worker_free(worker);
}

int orl_worker_start(uv_loop_t *loop, struct orl_worker_spec *spec, struct orl_worker **ret_worker,
                     struct orl_error *err)
{
    struct orl_worker *worker = calloc(1, sizeof *worker);
    if (!worker) {
        orl_bundle_done(&spec->bundle);
        return orl_error_no_memory(err);
    }
    worker->spec = *spec;
    worker->progress.warnings = (const char *const *)worker->warnings;
    memset(&spec->bundle, 0, sizeof spec->bundle);
    pthread_mutex_init(&worker->news_mutex, NULL);
    worker->pool = orl_thread_pool_new(spec->threads);
    worker->members = calloc(spec->threads, sizeof *worker->members);
    if (!worker->pool || !worker->members) {
        worker_free(worker);
        return orl_error_no_memory(err);
    }
    /* The lead is queued first, so that it is never behind threads that wait for it. */
    for (uint32_t i = 0; i < spec->threads; i++) {
        worker->members[i] = (struct orl_worker_member){.worker = worker, .index = i};
        worker->members[i].work.data = &worker->members[i];
        uv_queue_work(loop, &worker->members[i].work, member_work, member_back);
        worker->queued++;
    }
    *ret_worker = worker;
    return 0;
}

void orl_worker_cancel(struct orl_worker *worker)
{
    atomic_store(&worker->cancel, true);
}

void orl_worker_stop(struct orl_worker *worker)
{
    atomic_store(&worker->stopped, true);
    orl_worker_cancel(worker);
}

void orl_worker_progress(struct orl_worker *worker, struct orl_job_progress *ret_progress)
{
    pthread_mutex_lock(&worker->news_mutex);
    *ret_progress = worker->progress;
    ret_progress->eta_s = orl_eta_s(&worker->eta, orl_time_steady_s());
    pthread_mutex_unlock(&worker->news_mutex);
    ret_progress->stage = (enum orl_stage)atomic_load(&worker->stage);
    ret_progress->stage_fraction = atomic_load(&worker->stage_ppm) / (double)ORL_WORKER_WHOLE;
    ret_progress->job_fraction = atomic_load(&worker->job_ppm) / (double)ORL_WORKER_WHOLE;
    ret_progress->technique = (enum orl_technique)atomic_load(&worker->technique);
}

char *orl_worker_results(struct orl_worker *worker, char ret_folder[ORL_PATH_MAX])
{
    pthread_mutex_lock(&worker->news_mutex);
    char *summary = worker->results ? strdup(worker->results) : NULL;
    if (summary)
        snprintf(ret_folder, ORL_PATH_MAX, "%s", worker->output);
    pthread_mutex_unlock(&worker->news_mutex);
    return summary;
}
