/* Render jobs: their progress, their parts as they are finished, and jobs of several skies. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/job/skies.h>

#include "process/times.h"
#include "result/result_json.h"
#include "runner/checkpoints.h"
#include "runner/worker/worker_run.h"
#include "view/view_json.h"
#include "json/encode.h"

static int to_ppm(double fraction)
{
    return fraction >= 1 ? ORL_WORKER_WHOLE : fraction > 0 ? (int)(fraction * ORL_WORKER_WHOLE) : 0;
}

void orl_worker_set_eta(struct orl_worker *worker, double left_s)
{
    pthread_mutex_lock(&worker->news_mutex);
    orl_eta_update(&worker->eta, left_s, orl_time_steady_s());
    pthread_mutex_unlock(&worker->news_mutex);
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                        double left_s)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->stage, (int)stage);
    atomic_store(&worker->stage_ppm, to_ppm(stage_fraction));
    atomic_store(&worker->job_ppm, to_ppm(job_fraction));
    orl_worker_set_eta(worker, left_s);
}

static void on_plan_ready(void *ctx, const struct orl_plan *plan)
{
    struct orl_worker *worker = ctx;
    atomic_store(&worker->technique, (int)plan->technique);
}

static void on_warned(void *ctx, const char *warning)
{
    struct orl_worker *worker = ctx;
    bool known =
        worker->progress.n_warnings == ORL_WORKER_WARNINGS; /* the result has all warnings */
    for (size_t i = 0; i < worker->progress.n_warnings; i++)
        known = known || strcmp(worker->warnings[i], warning) == 0;
    char *text = known ? NULL : strdup(warning);
    pthread_mutex_lock(&worker->news_mutex);
    if (text)
        worker->warnings[worker->progress.n_warnings++] = text;
    pthread_mutex_unlock(&worker->news_mutex);
}

static void on_map_ready(void *ctx, const struct orl_map_info *info)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    if (worker->progress.n_maps < sizeof worker->progress.maps / sizeof *worker->progress.maps)
        worker->progress.maps[worker->progress.n_maps++] = *info;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Publishes a summary, and takes ownership of it. NULL keeps the previous one. */
static void publish_intermediate(struct orl_worker *worker, char *summary)
{
    pthread_mutex_lock(&worker->news_mutex);
    char *before = worker->results;
    if (summary)
        worker->results = summary;
    pthread_mutex_unlock(&worker->news_mutex);
    if (summary)
        free(before);
}

/* Publishes the list of finished files. */
static void publish_files(struct orl_worker *worker)
{
    json_t *summary = json_pack("{s:O}", "files", worker->files);
    char *text = orl_json_text(summary, JSON_COMPACT);
    json_decref(summary);
    publish_intermediate(worker, text);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Writes the name of a part: the prefix of its sky followed by the name. */
static void name_part(const struct orl_worker *worker, const char *name, char ret_part[256])
{
    snprintf(ret_part, 256, "%.80s%.160s", worker->part.prefix, name);
}

/* Adds files of a view that can be fetched. */
static void add_view_files(struct orl_worker *worker, json_t *files)
{
    json_array_extend(worker->part.files, files);
    if (worker->part.files != worker->files)
        json_array_extend(worker->files, files);
    publish_files(worker);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.n_views++;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Writes the view's note, best effort: without it the view is rendered again after a restart. */
static void on_view_written(void *ctx, size_t index, const struct orl_view_result *view)
{
    struct orl_worker *worker = ctx;
    char part[256];
    json_t *files = json_array();
    (void)index;
    name_part(worker, view->name, part);
    if (orl_job_output_list_view(view, worker->output, files, &worker->part.lost) == 0) {
        orl_checkpoint_add(worker->output, part, files, orl_checkpoint_view_to_json(view), NULL);
        add_view_files(worker, files);
    }
    json_decref(files);
}

static bool on_view_kept(void *ctx, size_t index, struct orl_view_result *ret_view)
{
    struct orl_worker *worker = ctx;
    char part[256];
    json_t *files, *about;
    name_part(worker, worker->part.job->views[index].name, part);
    if (!orl_checkpoint_find(worker->output, part, &files, &about))
        return false;
    const bool kept = orl_checkpoint_view_from_json(about, ret_view);
    if (kept)
        add_view_files(worker, files);
    json_decref(files);
    json_decref(about);
    return kept;
}

/* Users' files have no such name. */
static const char sensors_part[] = "+sensors";

static void on_sensors_done(void *ctx, const struct orl_result *result)
{
    struct orl_worker *worker = ctx;
    char part[256];
    json_t *files = json_array();
    name_part(worker, sensors_part, part);
    if (orl_checkpoint_sensors_write(worker->output, part, result, NULL) == 0 &&
        orl_job_output_list(part, worker->output, files, NULL) == 0)
        orl_checkpoint_add(worker->output, part, files, json_object(), NULL);
    json_decref(files);
}

static bool on_sensors_kept(void *ctx, struct orl_result *result)
{
    struct orl_worker *worker = ctx;
    char part[256];
    name_part(worker, sensors_part, part);
    return orl_checkpoint_find(worker->output, part, NULL, NULL) &&
           orl_checkpoint_sensors_read(worker->output, part, result);
}

/* Publishes the results of a round. Intermediate results are best effort. */
static void on_round_ready(void *ctx, const struct orl_result *result)
{
    struct orl_worker *worker = ctx;
    char *summary = NULL;
    if (worker->progress.n_skies == 0)
        orl_job_output_write(result, "running", worker->output, &summary, NULL);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.outcome = result->outcome;
    pthread_mutex_unlock(&worker->news_mutex);
    publish_intermediate(worker, summary);
}

/* ---- The job --------------------------------------------------------------------------------- */

void orl_worker_add_health(void *ctx, const struct orl_result *spent)
{
    struct orl_worker *worker = ctx;
    orl_health_add(&worker->outcome.tally.health, &spent->health);
}

struct orl_run_env orl_worker_env(struct orl_worker *worker, const struct orl_files *files)
{
    return (struct orl_run_env){
        .pool = worker->pool,
        .files = files,
        .store = worker->progress.in_parts ? &worker->distributed.store : &worker->spec.maps,
        .tasks = worker->progress.in_parts ? &worker->distributed.tasks : NULL,
        .memory_cache = worker->spec.memory_cache,
        .files_id = worker->spec.scene,
        .output_folder = worker->output,
        .cancel = &worker->cancel,
        .now_s = orl_time_steady_for,
        .progress = on_progress,
        .plan_ready = on_plan_ready,
        .warned = on_warned,
        .map_ready = on_map_ready,
        .view_kept = on_view_kept,
        .view_written = on_view_written,
        .sensors_kept = on_sensors_kept,
        .sensors_done = on_sensors_done,
        .round_ready = on_round_ready,
        .spent = orl_worker_add_health,
        .ctx = worker,
    };
}

/* Adds the stage times of a successful run. */
static void add_times(struct orl_worker *worker, const struct orl_result *result)
{
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        worker->outcome.tally.stages_s[i] += result->timings_s[i];
}

int orl_worker_render(struct orl_worker *worker, const struct orl_job *job,
                      const struct orl_files *files, struct orl_error *err)
{
    const struct orl_run_env env = orl_worker_env(worker, files);
    struct orl_result result = {0};
    worker->files = json_array();
    worker->part = (struct orl_worker_part){.job = job, .prefix = "", .files = worker->files};
    int rc = orl_run(job, &env, &result, err);
    json_decref(worker->files);
    if (rc)
        return rc;
    add_times(worker, &result);
    rc = orl_job_output_write(&result, "succeeded", worker->output, &worker->outcome.summary, err);
    orl_result_done(&result);
    return rc;
}

/* ---- Several skies --------------------------------------------------------------------------- */

/*
 * Each sky's result is a file of its own, kept once it is finished.
 */

struct skies_run {
    struct orl_worker *worker;
    const struct orl_job *job;
    json_t *results;
};

static const char *name_of(const struct skies_run *p, size_t index)
{
    return p->job->skies[index].name;
}

/* Writes the name of a sky's part. Parts of views have no such name. */
static void name_sky_part(const struct skies_run *p, size_t index, char ret_part[96])
{
    snprintf(ret_part, 96, "+%.80s", name_of(p, index));
}

static void count_sky(struct orl_worker *worker)
{
    publish_files(worker);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.skies_done++;
    pthread_mutex_unlock(&worker->news_mutex);
}

static bool on_kept(void *ctx, size_t index)
{
    struct skies_run *p = ctx;
    char part[96], file[96], path[ORL_PATH_MAX];
    json_t *files;
    name_sky_part(p, index, part);
    if (!orl_checkpoint_find(p->worker->output, part, &files, NULL))
        return false;
    snprintf(file, sizeof file, "%.80s.json", name_of(p, index));
    orl_job_output_path(p->worker->output, file, path);
    json_t *result = json_load_file(path, 0, NULL);
    const bool kept = result && orl_skies_result_add(p->results, result) == 0;
    if (kept) {
        json_array_extend(p->worker->files, files);
        count_sky(p->worker);
    }
    json_decref(result);
    json_decref(files);
    return kept;
}

static void on_begins(void *ctx, size_t index, const struct orl_job *job, const char *file_prefix)
{
    struct skies_run *p = ctx;
    struct orl_worker *worker = p->worker;
    json_decref(worker->part.files);
    worker->part =
        (struct orl_worker_part){.job = job, .prefix = file_prefix, .files = json_array()};
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.n_maps = 0;
    memset(&worker->progress.outcome, 0, sizeof worker->progress.outcome);
    snprintf(worker->progress.sky, sizeof worker->progress.sky, "%s", name_of(p, index));
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Lists files of views rendered in rounds, which were not listed when written, and files of
 * sensors. */
static int list_rest(const struct skies_run *p, const struct orl_result *result, json_t *files,
                     struct orl_error *err)
{
    const bool in_rounds = result->outcome.asked;
    int rc = 0;
    for (size_t i = 0; in_rounds && i < result->n_views && rc == 0; i++)
        rc = orl_job_output_list_view(&result->views[i], p->worker->output, files, err);
    if (rc == 0)
        rc = orl_job_output_list_sensors(&result->sensor_files, p->worker->output, files, err);
    return rc ? rc : orl_job_output_list_grids(result, p->worker->output, files, err);
}

static int on_done(void *ctx, size_t index, const struct orl_result *result, struct orl_error *err)
{
    struct skies_run *p = ctx;
    struct orl_worker *worker = p->worker;
    char part[96];
    json_t *doc = orl_sky_result_to_json(result, name_of(p, index)), *files = json_array();
    int rc = worker->part.lost.code;
    if (rc && err)
        *err = worker->part.lost;
    if (rc == 0)
        rc = orl_sky_output_write(doc, name_of(p, index), worker->output, files, err);
    if (rc == 0)
        rc = list_rest(p, result, files, err);
    if (rc == 0 && orl_skies_result_add(p->results, doc))
        rc = orl_error_no_memory(err);
    if (rc == 0) {
        json_array_extend(worker->files, files);
        json_array_extend(worker->part.files, files);
        name_sky_part(p, index, part);
        orl_checkpoint_add(worker->output, part, worker->part.files, json_object(), NULL);
        add_times(worker, result);
        count_sky(worker);
    }
    json_decref(files);
    json_decref(doc);
    return rc;
}

int orl_worker_render_skies(struct orl_worker *worker, const struct orl_job *job,
                            const struct orl_files *files, struct orl_error *err)
{
    const struct orl_run_env env = orl_worker_env(worker, files);
    struct skies_run p = {worker, job,
                          orl_skies_result_new(job->seed, orl_thread_pool_size(worker->pool))};
    const struct orl_skies_env skies = {
        .ctx = &p, .kept = on_kept, .begins = on_begins, .done = on_done};
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.n_skies = job->n_skies;
    pthread_mutex_unlock(&worker->news_mutex);
    worker->files = json_array();
    int rc = p.results ? orl_run_skies(job, &env, &skies, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = orl_sequence_draw(job, worker->output, env.cancel, p.results, err);
    if (rc == 0)
        rc = orl_job_output_list_sequence(p.results, worker->output, worker->files, err);
    const bool cancelled = rc == ORL_ERR_CANCELLED && !atomic_load(&worker->stopped);
    if (cancelled)
        orl_job_output_set_cancel(NULL); /* finished skies are kept; listing them is quick */
    if (rc == 0 || (cancelled && worker->progress.skies_done > 0)) {
        const int written = orl_skies_output_write(p.results, rc == 0 ? "succeeded" : "cancelled",
                                                   job->n_skies, worker->output, worker->files,
                                                   &worker->outcome.summary, rc == 0 ? err : NULL);
        rc = rc == 0 ? written : rc;
    }
    if (cancelled && worker->outcome.summary)
        orl_job_output_prune(worker->files, worker->output);
    json_decref(worker->part.files);
    json_decref(worker->files);
    json_decref(p.results);
    return rc;
}
