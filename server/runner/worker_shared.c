/* A job in parts: sets up its shared folder, and reports on its parts. */
#include <stdio.h>
#include <stdlib.h>

#include "encode.h"
#include "process/times.h"
#include "runner/job_work.h"
#include "runner/runner_json.h"
#include "runner/worker_run.h"

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static void on_told(void *ctx, const struct orl_parts_count *count)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    worker->parts = *count;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* Queues news of a part. If they are not fetched for long, the oldest are dropped. */
static void on_part_told(void *ctx, const struct orl_part_news *told)
{
    struct orl_worker *worker = ctx;
    struct orl_worker_part_news news = {
        .part = told->part, .ran_s = told->ran_s, .limits = told->limits};
    snprintf(news.what, sizeof news.what, "%s", told->what);
    snprintf(news.wave, sizeof news.wave, "%s", told->wave);
    snprintf(news.why, sizeof news.why, "%.*s", (int)sizeof news.why - 1,
             told->why ? told->why : "");
    if (told->task > 0)
        snprintf(news.slurm, sizeof news.slurm, "%u_%u", told->task, told->part);
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
    const struct orl_shared_place *place = worker->spec.place;
    struct orl_shared_file *files = calloc(bundle->count + 1, sizeof *files);
    char folder[ORL_PATH_MAX];
    if (!files)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < bundle->count; i++)
        files[i] = (struct orl_shared_file){bundle->files[i].name, bundle->files[i].path};
    snprintf(folder, sizeof folder, "%.*s/%s", ORL_PATH_MAX - 80, place->folder,
             worker->spec.job_id);
    const struct orl_sharing_spec spec = {.folder = folder,
                                          .doc = doc,
                                          .files = files,
                                          .n_files = bundle->count,
                                          .threads = place->part_threads,
                                          .most = place->parts,
                                          .memory_bytes = worker->spec.memory_bytes,
                                          .program = place->program,
                                          .slurm = true,
                                          .words = place->words,
                                          .n_words = place->n_words,
                                          .cancel = &worker->cancel,
                                          .leaves = &worker->stopped,
                                          .now_s = now_s,
                                          .told = on_told,
                                          .part_told = on_part_told,
                                          .ctx = worker};
    const int rc = orl_sharing_open(&worker->sharing, &spec, err);
    free(files);
    return rc;
}

int orl_worker_share(struct orl_worker *worker, const struct orl_task *task, struct orl_error *err)
{
    char why[ORL_WHY_MAX];
    if (!worker->spec.place)
        return 0;
    const struct orl_files files = orl_bundle_provider(&worker->spec.bundle);
    const struct orl_job_work work = orl_job_work(task, &files);
    const bool in_parts = orl_job_goes_in_parts(&work, worker->spec.place->least_s, why);
    pthread_mutex_lock(&worker->news_mutex);
    worker->in_parts = in_parts;
    snprintf(worker->why_here, sizeof worker->why_here, "%s", why);
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
    json_t *runner = orl_runner_to_json(worker->in_parts, worker->why_here,
                                        worker->in_parts ? &worker->sharing.count : NULL);
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

void orl_worker_unshare(struct orl_worker *worker, int code)
{
    if (!worker->spec.place)
        return;
    add_runner(worker);
    worker->outcome.tally.parts = worker->sharing.count;
    worker->outcome.tally.parts.waiting = worker->outcome.tally.parts.running = 0;
    const bool anew = code == ORL_ERR_CANCELLED && atomic_load(&worker->stopped);
    if (worker->in_parts)
        orl_sharing_done(&worker->sharing, !anew);
}
