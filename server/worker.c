#include "worker.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "job_output.h"
#include "kept_views.h"
#include "times.h"

enum { RENDER_NICE = 10, FRACTION_ONE = 1000000 };

/* One pool work: a member of the crew. */
struct member {
    uv_work_t work;
    struct orl_worker *worker;
    uint32_t index;
};

struct orl_worker {
    struct orl_worker_spec spec;
    struct orl_crew *crew;
    struct member *members;
    uint32_t queued;                   /* works that have not come back; loop thread */
    struct orl_worker_outcome outcome; /* the lead's, then the loop's once all are back */
    atomic_bool cancel, stopped;
    bool keeps; /* its views, when stopped; the lead's */
    atomic_int stage, stage_ppm, job_ppm, technique;
    pthread_mutex_t news_mutex;
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    struct orl_outcome rounds; /* as the last round left it */
    char *results;             /* their summary, or that of the views done; owned */
    size_t n_views;            /* done */
    json_t *files;             /* theirs; the lead's */
    const struct orl_job *job; /* the lead's, while it renders */
    char output[ORL_PATH_MAX]; /* where they are; set before there are any */
    struct orl_study_step step;
    struct orl_study_point *points; /* room for n_settings; those below n_points never change */
    size_t n_settings, n_points;
};

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static int to_ppm(double fraction)
{
    return fraction >= 1 ? FRACTION_ONE : fraction > 0 ? (int)(fraction * FRACTION_ONE) : 0;
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->stage, (int)stage);
    atomic_store(&worker->stage_ppm, to_ppm(stage_fraction));
    atomic_store(&worker->job_ppm, to_ppm(job_fraction));
}

static void on_plan_ready(void *ctx, const struct orl_plan *plan)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->technique, (int)plan->technique);
}

static void on_map_ready(void *ctx, const struct orl_map_info *info)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    if (worker->n_maps < sizeof worker->maps / sizeof *worker->maps)
        worker->maps[worker->n_maps++] = *info;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Takes summary, NULL included: then what was there stays. */
static void show_results(struct orl_worker *worker, char *summary)
{
    pthread_mutex_lock(&worker->news_mutex);
    char *before = worker->results;
    if (summary)
        worker->results = summary;
    pthread_mutex_unlock(&worker->news_mutex);
    if (summary)
        free(before);
}

static void show_view(struct orl_worker *worker, const struct orl_view_result *view)
{
    orl_kept_views_list(worker->output, view, worker->files);
    json_t *summary = json_pack("{s:O}", "files", worker->files);
    char *text = summary ? json_dumps(summary, JSON_COMPACT) : NULL;
    json_decref(summary);
    show_results(worker, text);
    pthread_mutex_lock(&worker->news_mutex);
    worker->n_views++;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* A note that cannot be written costs time alone, after a restart. */
static void on_view_written(void *ctx, size_t index, const struct orl_view_result *view)
{
    struct orl_worker *worker = ctx;
    (void)index;
    orl_kept_views_add(worker->output, view, NULL);
    show_view(worker, view);
}

static bool on_view_kept(void *ctx, size_t index, struct orl_view_result *ret_view)
{
    struct orl_worker *worker = ctx;
    if (!orl_kept_views_find(worker->output, worker->job->views[index].name, ret_view))
        return false;
    show_view(worker, ret_view);
    return true;
}

/* A result that cannot be written now will be missed by nobody but who asks now. */
static void on_round_ready(void *ctx, const struct orl_result *result)
{
    struct orl_worker *worker = ctx;
    char *summary = NULL;
    orl_job_output_write(result, "running", worker->output, &summary, NULL);
    pthread_mutex_lock(&worker->news_mutex);
    worker->rounds = result->outcome;
    pthread_mutex_unlock(&worker->news_mutex);
    show_results(worker, summary);
}

static void on_study_progress(void *ctx, const struct orl_study_step *step)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->job_ppm, to_ppm(step->fraction));
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

/* What is asked for, read back from the document; its main files are the bundle's. */
static int read_document(struct orl_worker *worker, struct orl_task *ret_task,
                         struct orl_error *err)
{
    struct orl_file file;
    int rc = orl_map_file(worker->spec.document_path, &file, err);
    if (rc)
        return rc;
    rc = orl_job_read(file.data, file.size, ret_task, NULL, err);
    orl_unmap_file(&file);
    if (rc == 0) {
        rc = orl_job_set_scene(orl_task_job(ret_task), &worker->spec.bundle, err);
        if (rc)
            orl_task_done(ret_task);
    }
    return rc;
}

static void on_spent(void *ctx, const struct orl_result *spent)
{
    struct orl_worker *worker = ctx;
    orl_health_add(&worker->outcome.tally.health, &spent->health);
}

static int run_render(struct orl_worker *worker, const struct orl_job *job,
                      const struct orl_files *files, const char *output, struct orl_error *err)
{
    struct orl_result result;
    memset(&result, 0, sizeof result);
    const struct orl_run_env env = {
        .crew = worker->crew,
        .files = files,
        .store = &worker->spec.maps,
        .shelf = worker->spec.shelf,
        .output_folder = output,
        .cancel = &worker->cancel,
        .now_s = now_s,
        .progress = on_progress,
        .plan_ready = on_plan_ready,
        .map_ready = on_map_ready,
        .view_kept = on_view_kept,
        .view_written = on_view_written,
        .round_ready = on_round_ready,
        .spent = on_spent,
        .ctx = worker,
    };
    worker->job = job;
    worker->files = json_array();
    int rc = orl_run(job, &env, &result, err);
    json_decref(worker->files);
    if (rc == 0) {
        orl_kept_views_forget(output, job);
        memcpy(worker->outcome.tally.stages_s, result.timings_s, sizeof result.timings_s);
        rc = orl_job_output_write(&result, "succeeded", output, &worker->outcome.summary, err);
        orl_result_done(&result);
    }
    return rc;
}

/* Without the map cache: what is measured begins without maps (oriel/study.h). */
static int run_study(struct orl_worker *worker, const struct orl_study_request *request,
                     const struct orl_files *files, const char *output, struct orl_error *err)
{
    struct orl_study study = {0};
    const struct orl_study_env env = {
        .crew = worker->crew,
        .files = files,
        .work_folder = output,
        .cancel = &worker->cancel,
        .now_s = now_s,
        .progress = on_study_progress,
        .point_ready = on_study_point,
        .spent = on_spent,
        .ctx = worker,
    };
    const size_t n_settings = orl_study_count_settings(request);
    worker->points = calloc(n_settings, sizeof *worker->points);
    if (!worker->points)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    pthread_mutex_lock(&worker->news_mutex);
    worker->n_settings = n_settings;
    pthread_mutex_unlock(&worker->news_mutex);
    int rc = orl_study_run(request, &env, &study, err);
    if (rc == 0) {
        rc = orl_study_output_write(&study, request, output, &worker->outcome.summary, err);
        orl_study_done(&study);
    }
    return rc;
}

/* Only views that are there once and for all are of use to a later start. */
static int make_folder(struct orl_worker *worker, const struct orl_task *task, const char *output,
                       struct orl_error *err)
{
    const struct orl_goal *goal = &task->of.render.goal;
    worker->keeps =
        task->kind == ORL_TASK_RENDER && goal->relative_error == 0 && goal->deadline_s == 0;
    const int rc = worker->keeps ? 0 : orl_remove_tree(output, err);
    if (rc == 0 && mkdir(output, 0777) != 0 && errno != EEXIST)
        return orl_error_set(err, ORL_ERR_IO, "cannot make a folder for the results: %s",
                             strerror(errno));
    return rc;
}

static int run_document(struct orl_worker *worker, const char *output, struct orl_error *err)
{
    struct orl_task task;
    int rc = read_document(worker, &task, err);
    if (rc)
        return rc;
    rc = make_folder(worker, &task, output, err);
    if (rc) {
        orl_task_done(&task);
        return rc;
    }
    const struct orl_files files = orl_bundle_provider(&worker->spec.bundle);
    rc = task.kind == ORL_TASK_STUDY ? run_study(worker, &task.of.study, &files, output, err)
                                     : run_render(worker, &task.of.render, &files, output, err);
    orl_task_done(&task);
    return rc;
}

/* Everything the lead does; returns the job's code. */
static int lead(struct orl_worker *worker, struct orl_error *err)
{
    char final[ORL_PATH_MAX];
    const char *output = worker->output;
    orl_kept_views_folder(worker->spec.folders, worker->spec.job_id, worker->output);
    orl_folders_path(worker->spec.folders, final, "results/%s", worker->spec.job_id);
    int rc = run_document(worker, output, err);
    if (rc == 0)
        rc = orl_sync_path(output, err);
    /* A crash between the rename and the row leaves results of an earlier attempt. */
    if (rc == 0)
        rc = orl_remove_tree(final, err);
    if (rc == 0)
        rc = orl_rename_synced(output, final, err);
    if (rc && !(rc == ORL_ERR_CANCELLED && worker->keeps && atomic_load(&worker->stopped)))
        orl_remove_tree(output, NULL);
    return rc;
}

static void member_work(uv_work_t *work)
{
    struct member *member = work->data;
    struct orl_worker *worker = member->worker;
    /* Lowers this thread alone (Linux). It cannot be raised again without privileges, which is
     * well: pool threads do nothing that should come before the loop. */
    setpriority(PRIO_PROCESS, (id_t)gettid(), RENDER_NICE);
    if (member->index > 0) {
        orl_crew_serve(worker->crew, member->index);
        return;
    }
    worker->outcome.code = lead(worker, &worker->outcome.err);
    orl_crew_dismiss(worker->crew);
}

static void worker_free(struct orl_worker *worker)
{
    if (!worker)
        return;
    orl_bundle_done(&worker->spec.bundle);
    orl_crew_free(worker->crew);
    pthread_mutex_destroy(&worker->news_mutex);
    free(worker->members);
    free(worker->points);
    free(worker->results);
    free(worker);
}

static void member_back(uv_work_t *work, int status)
{
    (void)status; /* works are never cancelled: the crew must be dismissed by its lead */
    struct orl_worker *worker = ((struct member *)work->data)->worker;
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
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    worker->spec = *spec;
    memset(&spec->bundle, 0, sizeof spec->bundle);
    pthread_mutex_init(&worker->news_mutex, NULL);
    worker->crew = orl_crew_new(spec->threads);
    worker->members = calloc(spec->threads, sizeof *worker->members);
    if (!worker->crew || !worker->members) {
        worker_free(worker);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    /* The lead is queued first, so that it is never behind servers that wait for it. */
    for (uint32_t i = 0; i < spec->threads; i++) {
        worker->members[i] = (struct member){.worker = worker, .index = i};
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

void orl_worker_progress(struct orl_worker *worker, struct orl_progress *ret_progress)
{
    ret_progress->stage = (enum orl_stage)atomic_load(&worker->stage);
    ret_progress->stage_fraction = atomic_load(&worker->stage_ppm) / (double)FRACTION_ONE;
    ret_progress->job_fraction = atomic_load(&worker->job_ppm) / (double)FRACTION_ONE;
    ret_progress->technique = (enum orl_technique)atomic_load(&worker->technique);
    pthread_mutex_lock(&worker->news_mutex);
    ret_progress->n_maps = worker->n_maps;
    memcpy(ret_progress->maps, worker->maps, sizeof worker->maps);
    ret_progress->outcome = worker->rounds;
    ret_progress->n_views = worker->n_views;
    ret_progress->step = worker->step;
    ret_progress->n_settings = worker->n_settings;
    ret_progress->points = worker->points;
    ret_progress->n_points = worker->n_points;
    pthread_mutex_unlock(&worker->news_mutex);
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
