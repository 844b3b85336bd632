/*
 * Tasks that other processes may compute: those of a run, and those of a BSDF that is being
 * made.
 */
#include "run/distributed/task_work.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf/bsdf_store.h>

#include "run/cache/word_file.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"

/* Version of the tasks' content and file layout; raised when either changes. */
static const char recipe[] = "oriel pieces 5";

bool orl_run_is_distributed(const struct orl_run_state *state)
{
    return state->env->tasks && state->env->store && !state->pilot;
}

/* ---- Keys ------------------------------------------------------------------------------------ */

void orl_task_key_begin(const struct orl_run_state *state, struct orl_sha256 *hash)
{
    const struct orl_run_env *env = state->env;
    const struct orl_job *job = state->job;
    const char *sky = env->file_prefix ? env->file_prefix : "";
    const uint64_t numbers[] = {
        job->seed, job->gather_samples, (uint64_t)state->result->plan.technique,
        state->result->plan.photons_global, state->result->plan.photons_caustic};
    orl_sha256_init(hash);
    orl_sha256_add(hash, recipe, sizeof recipe);
    orl_sha256_add(hash, env->tasks->job, strlen(env->tasks->job) + 1);
    orl_sha256_add(hash, sky, strlen(sky) + 1);
    orl_sha256_add(hash, numbers, sizeof numbers);
    orl_sha256_add(hash, state->scene->parsed_scene.digest, ORL_SHA256_BYTES);
    orl_scene_digest_build(state->scene, hash);
    orl_sha256_add(hash, state->round.shift, sizeof state->round.shift);
    if (state->round.bandwidths)
        orl_sha256_add(hash, state->round.bandwidths,
                       ORL_MAP_KINDS * sizeof *state->round.bandwidths);
}

void orl_task_key_end(struct orl_sha256 *hash, char ret_key[ORL_JOB_TASK_KEY])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_key, ORL_JOB_TASK_KEY, digest, sizeof digest);
}

void orl_task_work_estimate(const struct orl_run_state *state, struct orl_task_work *work,
                            double share)
{
    const double pool = orl_thread_pool_size(state->env->pool);
    const double core_s = pool * share * state->clock.cost_s[ORL_STAGE_RENDER];
    double all = 0;
    for (size_t i = 0; i < work->n; i++)
        all += work->tasks[i].work;
    for (size_t i = 0; i < work->n && all > 0; i++)
        work->tasks[i].core_s = core_s * work->tasks[i].work / all;
}

/* ---- Tasks ---------------------------------------------------------------------------------- */

/* Takes a task from the store if it is there and intact. */
static int find_task(const struct orl_run_env *env, const struct orl_task_work *work, size_t index,
                     bool *ret_found, struct orl_error *err)
{
    const struct orl_map_store *store = env->store;
    const struct orl_job_task *job_task = &work->tasks[index];
    struct orl_map_info info;
    struct orl_word_file_info file_info;
    char path[4096];
    void *data = NULL;
    size_t size = 0;
    bool hit = false;
    int code = store->acquire(store->ctx, job_task->kind, job_task->key, env->cancel, path, &hit,
                              &info, err);
    if (code < 0)
        return code;
    if (hit && orl_word_file_read(path, job_task->key, &file_info, &data, &size, NULL) == 0)
        code = work->take(work->ctx, index, data, size, ret_found, err);
    free(data);
    if (*ret_found)
        store->release(store->ctx, job_task->kind, job_task->key);
    else
        store->abandon(store->ctx, job_task->kind, job_task->key);
    return code;
}

static int store_task(const struct orl_run_env *env, const struct orl_job_task *job_task,
                      const void *data, size_t size, struct orl_error *err)
{
    const struct orl_map_store *store = env->store;
    struct orl_map_info info;
    struct orl_word_file_info file_info = {.target = 0};
    char path[4096];
    bool hit = false;
    int code = store->acquire(store->ctx, job_task->kind, job_task->key, env->cancel, path, &hit,
                              &info, err);
    if (code < 0 || hit) { /* another process has stored it first */
        if (code == 0)
            store->release(store->ctx, job_task->kind, job_task->key);
        return code;
    }
    memcpy(file_info.key, job_task->key, sizeof file_info.key);
    code = orl_word_file_write(path, &file_info, data, size, err);
    info = (struct orl_map_info){.stored = size / sizeof(float), .bytes = file_info.bytes};
    memcpy(info.kind, job_task->kind, sizeof info.kind);
    memcpy(info.key, job_task->key, sizeof info.key);
    if (code == 0)
        code = store->commit(store->ctx, &info, err);
    if (code == 0)
        store->release(store->ctx, job_task->kind, job_task->key);
    else
        store->abandon(store->ctx, job_task->kind, job_task->key);
    return code;
}

static int make_task(const struct orl_run_env *env, const struct orl_task_work *work, size_t index,
                     struct orl_error *err)
{
    void *data = NULL;
    size_t size = 0;
    int code = work->make(work->ctx, index, &data, &size, err);
    if (code == 0)
        code = store_task(env, &work->tasks[index], data, size, err);
    free(data);
    return code;
}

/* Missing tasks, and which of them are made here. */
struct missing_tasks {
    struct orl_job_task *tasks;
    size_t *indices; /* their indices in the work */
    bool *here, *done;
    size_t n;
};

static void missing_tasks_done(struct missing_tasks *w)
{
    free(w->tasks);
    free(w->indices);
    free(w->here);
    free(w->done);
}

static int find_missing(const struct orl_run_env *env, const struct orl_task_work *work,
                        struct missing_tasks *w, struct orl_error *err)
{
    int code = 0;
    w->n = 0;
    for (size_t i = 0; i < work->n && code == 0; i++) {
        if (!w->done[i])
            code = find_task(env, work, i, &w->done[i], err);
        if (w->done[i])
            continue;
        w->here[w->n] = false;
        w->indices[w->n] = i;
        w->tasks[w->n++] = work->tasks[i];
    }
    return code;
}

/* Distributes the missing tasks among processes and makes this run's own. */
static int claim_missing(const struct orl_run_env *env, const struct orl_task_work *work,
                         struct missing_tasks *w, struct orl_error *err)
{
    const struct orl_job_tasks_watch watch = {work->told, work->ctx};
    int code =
        orl_job_tasks_claim(env->tasks, w->tasks, w->n, w->here, work->told ? &watch : NULL, err);
    for (size_t i = 0; i < w->n && code == 0; i++)
        if (w->here[i]) {
            code = make_task(env, work, w->indices[i], err);
            w->done[w->indices[i]] = true;
        }
    return code == 0 && orl_job_tasks_should_stop(env->tasks)
               ? orl_error_set(err, ORL_ERR_CANCELLED, "all tasks of the run are done")
               : code;
}

int orl_run_tasks(const struct orl_run_env *env, const struct orl_task_work *work,
                  struct orl_error *err)
{
    struct missing_tasks w = {.tasks = calloc(work->n + 1, sizeof *w.tasks),
                              .indices = calloc(work->n + 1, sizeof *w.indices),
                              .here = calloc(work->n + 1, sizeof *w.here),
                              .done = calloc(work->n + 1, sizeof *w.done)};
    size_t before = SIZE_MAX;
    int code = w.tasks && w.indices && w.here && w.done
                   ? find_missing(env, work, &w, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a job");
    while (code == 0 && w.n > 0) {
        if (w.n >= before)
            code = orl_error_set(err, ORL_ERR_INTERNAL,
                                 "results of %zu tasks that other processes finished are missing",
                                 w.n);
        before = w.n;
        if (code == 0)
            code = claim_missing(env, work, &w, err);
        if (code == 0)
            code = find_missing(env, work, &w, err);
    }
    missing_tasks_done(&w);
    return code;
}

/* ---- Counts and warnings --------------------------------------------------------------------- */

static struct orl_job_task record_task(const char *kind, const char *key)
{
    struct orl_job_task job_task = {.work = 1};
    snprintf(job_task.kind, sizeof job_task.kind, "%s", kind);
    snprintf(job_task.key, sizeof job_task.key, "%s", key);
    return job_task;
}

void orl_run_store_counts(const struct orl_run_state *state, const char *key,
                          const struct orl_health *health)
{
    const struct orl_job_task job_task = record_task("counts", key);
    store_task(state->env, &job_task, health, sizeof *health, NULL);
}

static int load_counts(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                       struct orl_error *err)
{
    struct orl_run_state *state = ctx;
    struct orl_health health;
    (void)index, (void)err;
    *ret_taken = size == sizeof health;
    if (*ret_taken) {
        memcpy(&health, data, sizeof health);
        orl_health_add(&state->result->health, &health);
    }
    return 0;
}

bool orl_run_load_counts(struct orl_run_state *state, const char *key)
{
    struct orl_job_task job_task = record_task("counts", key);
    const struct orl_task_work work = {
        .tasks = &job_task, .n = 1, .ctx = state, .take = load_counts};
    bool found = false;
    find_task(state->env, &work, 0, &found, NULL);
    return found;
}

/* Packs NUL-terminated warnings, padded with zeros to whole words. */
void orl_run_store_warnings(const struct orl_run_state *state, const char *key, size_t first)
{
    const struct orl_job_task job_task = record_task("warned", key);
    const struct orl_result *result = state->result;
    size_t size = 0;
    for (size_t i = first; i < result->n_warnings; i++)
        size += strlen(result->warnings[i]) + 1;
    size = (size + 3) / 4 * 4;
    char *text = calloc(1, size + 1), *to = text;
    for (size_t i = first; text && i < result->n_warnings; i++)
        to = stpcpy(to, result->warnings[i]) + 1;
    if (text && size > 0)
        store_task(state->env, &job_task, text, size, NULL);
    free(text);
}

static int load_warnings(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                         struct orl_error *err)
{
    struct orl_run_state *state = ctx;
    const char *at = data, *end = at + size;
    (void)index, (void)err;
    *ret_taken = size > 0 && end[-1] == '\0';
    for (; *ret_taken && at < end; at += strlen(at) + 1)
        if (*at)
            orl_run_warn_once(state, "%s", at);
    return 0;
}

void orl_run_load_warnings(struct orl_run_state *state, const char *key)
{
    struct orl_job_task job_task = record_task("warned", key);
    const struct orl_task_work work = {
        .tasks = &job_task, .n = 1, .ctx = state, .take = load_warnings};
    bool found = false;
    find_task(state->env, &work, 0, &found, NULL);
}

void orl_run_move_health(const struct orl_run_state *state, struct orl_health *ret_health)
{
    *ret_health = (struct orl_health){.rays = 0};
    for (uint32_t i = 0; i < orl_thread_pool_size(state->env->pool); i++) {
        orl_health_add(ret_health, &state->searches[i].health);
        state->searches[i].health = (struct orl_health){.rays = 0};
    }
}

/* Version of a task's content and file layout; change it with either. */
static const char bsdf_recipe[] = "oriel bsdf lots 2";

static void name_bsdf_task(const char *job, const struct orl_bsdf_tasks *bsdf_tasks, size_t index,
                           struct orl_job_task *ret_task)
{
    struct orl_sha256 hash;
    const uint64_t number = index;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, bsdf_recipe, sizeof bsdf_recipe);
    orl_sha256_add(&hash, job, strlen(job) + 1);
    orl_sha256_add(&hash, bsdf_tasks->name, strlen(bsdf_tasks->name) + 1);
    orl_sha256_add(&hash, &number, sizeof number);
    *ret_task =
        (struct orl_job_task){.kind = "lot", .core_s = bsdf_tasks->core_s(bsdf_tasks->ctx, index)};
    ret_task->work = ret_task->core_s;
    orl_task_key_end(&hash, ret_task->key);
}

static int run_bsdf_tasks(void *ctx, const struct orl_bsdf_tasks *bsdf_tasks, struct orl_error *err)
{
    const struct orl_bsdf_task_store *state = ctx;
    const struct orl_run_env run = {.store = state->store, .tasks = state->tasks};
    struct orl_task_work work = {.n = bsdf_tasks->n,
                                 .ctx = bsdf_tasks->ctx,
                                 .make = bsdf_tasks->make,
                                 .take = bsdf_tasks->take,
                                 .told = bsdf_tasks->told};
    work.tasks = calloc(bsdf_tasks->n + 1, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a job");
    for (size_t i = 0; i < bsdf_tasks->n; i++)
        name_bsdf_task(state->tasks->job, bsdf_tasks, i, &work.tasks[i]);
    const int code = orl_run_tasks(&run, &work, err);
    free(work.tasks);
    return code;
}

struct orl_bsdf_distributor orl_bsdf_distribute(struct orl_bsdf_task_store *state)
{
    return (struct orl_bsdf_distributor){state, run_bsdf_tasks};
}
