/* A job in parts: sets up its shared folder, and reports on its parts. */
#include <stdio.h>
#include <stdlib.h>

#include "process/times.h"
#include "runner/estimate/job_estimate.h"
#include "runner/runner.h"
#include "runner/worker/worker_run.h"
#include "json/encode.h"

static void on_parts_progress(void *ctx, const struct orl_parts_count *count)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.parts = *count;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Queues news of a part. If they are not fetched for long, the oldest are dropped. */
static void on_part_event(void *ctx, const struct orl_part_event *reported)
{
    struct orl_worker *worker = ctx;
    struct orl_worker_part_news news = {
        .part = reported->part, .ran_s = reported->ran_s, .limits = reported->limits};
    snprintf(news.what, sizeof news.what, "%s", reported->what);
    snprintf(news.round, sizeof news.round, "%s", reported->round);
    snprintf(news.why, sizeof news.why, "%.*s", (int)sizeof news.why - 1,
             reported->why ? reported->why : "");
    if (reported->task > 0)
        snprintf(news.slurm, sizeof news.slurm, "%u_%u", reported->task, reported->part);
    pthread_mutex_lock(&worker->news_mutex);
    if (!worker->news)
        worker->news = calloc(ORL_WORKER_NEWS, sizeof *worker->news);
    if (worker->news && worker->n_news == ORL_WORKER_NEWS) {
        worker->first_news = (worker->first_news + 1) % ORL_WORKER_NEWS;
        worker->n_news--;
    }
    if (worker->news)
        worker->news[(worker->first_news + worker->n_news++) % ORL_WORKER_NEWS] = news;
    pthread_mutex_unlock(&worker->news_mutex);
}

bool orl_worker_part_news(struct orl_worker *worker, struct orl_worker_part_news *ret_news)
{
    pthread_mutex_lock(&worker->news_mutex);
    const bool any = worker->n_news > 0;
    if (any) {
        *ret_news = worker->news[worker->first_news];
        worker->first_news = (worker->first_news + 1) % ORL_WORKER_NEWS;
        worker->n_news--;
    }
    pthread_mutex_unlock(&worker->news_mutex);
    return any;
}

/* Returns the document as the oriel command reads it: with the names of its scene's files, which
 * are in the same folder. */
static json_t *local_document(const struct orl_worker *worker)
{
    const struct orl_bundle *bundle = &worker->spec.bundle;
    json_t *doc = json_load_file(worker->spec.document_path, 0, NULL), *names = json_array();
    for (size_t i = 0; i < bundle->count; i++)
        if (!bundle->files[i].resource)
            json_array_append_new(names, json_string(bundle->files[i].name));
    if (json_object_set_new(doc, "scene", json_pack("{s:o}", "files", names)) == 0)
        return doc;
    json_decref(doc);
    return NULL;
}

static int set_up_folder(struct orl_worker *worker, const json_t *doc, struct orl_error *err)
{
    const struct orl_bundle *bundle = &worker->spec.bundle;
    const struct orl_slurm_config *slurm = worker->spec.slurm;
    struct orl_shared_file *files = calloc(bundle->count + 1, sizeof *files);
    char folder[ORL_PATH_MAX];
    if (!files)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < bundle->count; i++)
        files[i] = (struct orl_shared_file){bundle->files[i].name, bundle->files[i].path};
    snprintf(folder, sizeof folder, "%.*s/%s", ORL_PATH_MAX - 80, slurm->folder,
             worker->spec.job_id);
    const struct orl_distributed_job_spec spec = {.folder = folder,
                                                  .doc = doc,
                                                  .files = files,
                                                  .n_files = bundle->count,
                                                  .threads = slurm->part_threads,
                                                  .most = slurm->parts,
                                                  .memory_bytes = worker->spec.memory_bytes,
                                                  .program = slurm->program,
                                                  .slurm = true,
                                                  .words = slurm->words,
                                                  .n_words = slurm->n_words,
                                                  .cancel = &worker->cancel,
                                                  .detach = &worker->stopped,
                                                  .now_s = orl_time_steady_for,
                                                  .reported = on_parts_progress,
                                                  .part_event = on_part_event,
                                                  .ctx = worker};
    const int rc = orl_distributed_job_open(&worker->distributed, &spec, err);
    free(files);
    return rc;
}

int orl_worker_begin_parts(struct orl_worker *worker, const struct orl_job_request *task,
                           struct orl_error *err)
{
    char why[ORL_WHY_MAX];
    if (!worker->spec.slurm)
        return 0;
    const struct orl_files files = orl_bundle_provider(&worker->spec.bundle);
    const struct orl_job_work work = orl_job_work(task, &files);
    const bool in_parts = orl_job_is_split(&work, worker->spec.slurm->least_s, why);
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.in_parts = in_parts;
    snprintf(worker->progress.why_here, sizeof worker->progress.why_here, "%s", why);
    pthread_mutex_unlock(&worker->news_mutex);
    if (!in_parts)
        return 0;
    json_t *doc = local_document(worker);
    const int rc = doc ? set_up_folder(worker, doc, err)
                       : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a document");
    json_decref(doc);
    return rc;
}

/* Adds the runner to the summary of the results. Without memory, the summary stays without it. */
static void add_runner(struct orl_worker *worker)
{
    struct orl_worker_outcome *outcome = &worker->outcome;
    json_t *summary = outcome->summary ? json_loads(outcome->summary, 0, NULL) : NULL;
    json_t *runner =
        orl_runner_to_json(worker->progress.in_parts, worker->progress.why_here,
                           worker->progress.in_parts ? &worker->distributed.count : NULL);
    char *text = NULL;
    if (summary && json_object_set(summary, "runner", runner) == 0)
        text = orl_json_text(summary, JSON_COMPACT);
    if (text) {
        free(outcome->summary);
        outcome->summary = text;
    }
    json_decref(runner);
    json_decref(summary);
}

void orl_worker_end_parts(struct orl_worker *worker, int code)
{
    if (!worker->spec.slurm)
        return;
    add_runner(worker);
    worker->outcome.tally.parts = worker->distributed.count;
    worker->outcome.tally.parts.waiting = worker->outcome.tally.parts.running = 0;
    const bool anew = code == ORL_ERR_CANCELLED && atomic_load(&worker->stopped);
    if (worker->progress.in_parts)
        orl_distributed_job_done(&worker->distributed, !anew);
}
