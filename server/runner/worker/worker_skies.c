/* A job of several skies: each sky's result is a file of its own, kept once it is finished. */
#include <oriel/job/skies.h>
#include <stdio.h>
#include <string.h>

#include "result/skies_result_json.h"
#include "runner/checkpoints.h"
#include "runner/worker/worker_run.h"
#include "view/sequence_json.h"

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
static void name_part(const struct skies_run *p, size_t index, char ret_part[96])
{
    snprintf(ret_part, 96, "+%.80s", name_of(p, index));
}

static void count_sky(struct orl_worker *worker)
{
    orl_worker_publish_files(worker);
    pthread_mutex_lock(&worker->news_mutex);
    worker->skies_done++;
    pthread_mutex_unlock(&worker->news_mutex);
}

static bool on_kept(void *ctx, size_t index)
{
    struct skies_run *p = ctx;
    char part[96], file[96], path[ORL_PATH_MAX];
    json_t *files, *about;
    name_part(p, index, part);
    if (!orl_checkpoint_find(p->worker->output, part, &files, &about))
        return false;
    json_decref(about);
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
    worker->n_maps = 0;
    memset(&worker->rounds, 0, sizeof worker->rounds);
    snprintf(worker->sky, sizeof worker->sky, "%s", name_of(p, index));
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
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0) {
        json_array_extend(worker->files, files);
        json_array_extend(worker->part.files, files);
        name_part(p, index, part);
        orl_checkpoint_add(worker->output, part, worker->part.files, json_object(), NULL);
        orl_worker_add_times(worker, result);
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
    worker->n_skies = job->n_skies;
    pthread_mutex_unlock(&worker->news_mutex);
    worker->files = json_array();
    int rc = p.results ? orl_run_skies(job, &env, &skies, err)
                       : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0)
        rc = orl_sequence_draw(job, worker->output, env.cancel, p.results, err);
    if (rc == 0)
        rc = orl_job_output_list_sequence(p.results, worker->output, worker->files, err);
    const bool cancelled = rc == ORL_ERR_CANCELLED && !atomic_load(&worker->stopped);
    if (cancelled)
        orl_job_output_set_cancel(NULL); /* finished skies are kept; listing them is quick */
    if (rc == 0 || (cancelled && worker->skies_done > 0)) {
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
