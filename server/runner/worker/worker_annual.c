/* A running annual job: rows of its sensors are stored when they are finished. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "annual_job/annual_job.h"
#include "runner/checkpoints.h"
#include "runner/worker/worker_run.h"
#include "store/files/folders.h"

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Writes the name of a block's part and file. Users' files have no such names. */
static void name_chunk(const struct orl_annual_chunk *chunk, char ret_name[64])
{
    snprintf(ret_name, 64, "+rows%u-%zu", chunk->round, chunk->first);
}

static size_t numbers_of(const struct orl_annual_chunk *chunk)
{
    return chunk->count * chunk->n_columns;
}

/* One of a block's arrays, which are stored one after the other. */
struct array {
    float *at;
    size_t count;
};

enum { ARRAYS = 6 };

static void list_arrays(const struct orl_annual_chunk *chunk, struct array ret_arrays[ARRAYS])
{
    const size_t n = numbers_of(chunk);
    const struct array arrays[ARRAYS] = {{chunk->total, n},
                                         {chunk->direct, n},
                                         {chunk->se, n},
                                         {chunk->overcast, chunk->count},
                                         {chunk->overcast_se, chunk->count},
                                         {chunk->coherence, chunk->count}};
    memcpy(ret_arrays, arrays, sizeof arrays);
}

static size_t bytes_of(const struct orl_annual_chunk *chunk)
{
    return (3 * numbers_of(chunk) + 3 * chunk->count) * sizeof(float);
}

/* Stores a block, best effort: a block that is not stored is computed again after a restart. */
static void on_done(void *ctx, const struct orl_annual_chunk *chunk)
{
    const struct orl_worker *worker = ctx;
    const size_t bytes = bytes_of(chunk);
    struct array arrays[ARRAYS];
    char name[64], path[ORL_PATH_MAX];
    json_t *files = json_array();
    float *rows = malloc(bytes + 1), *to = rows;
    list_arrays(chunk, arrays);
    name_chunk(chunk, name);
    orl_job_output_path(worker->output, name, path);
    if (rows && files && bytes > 0) {
        for (int i = 0; i < ARRAYS; to += arrays[i++].count)
            memcpy(to, arrays[i].at, arrays[i].count * sizeof *to);
        if (orl_write_file(path, rows, bytes, NULL) == 0 &&
            orl_job_output_list(name, worker->output, files, NULL) == 0)
            orl_checkpoint_add(worker->output, name, files, json_object(), NULL);
    }
    free(rows);
    json_decref(files);
}

static bool read_chunk(const char *path, struct orl_annual_chunk *chunk)
{
    struct array arrays[ARRAYS];
    struct orl_file file;
    if (orl_map_file(path, &file, NULL))
        return false;
    const bool fits = file.size == bytes_of(chunk);
    const char *from = file.data;
    list_arrays(chunk, arrays);
    for (int i = 0; fits && i < ARRAYS; i++) {
        memcpy(arrays[i].at, from, arrays[i].count * sizeof(float));
        from += arrays[i].count * sizeof(float);
    }
    orl_unmap_file(&file);
    return fits;
}

static bool on_kept(void *ctx, struct orl_annual_chunk *chunk)
{
    const struct orl_worker *worker = ctx;
    char name[64], path[ORL_PATH_MAX];
    name_chunk(chunk, name);
    if (!orl_checkpoint_find(worker->output, name, NULL, NULL))
        return false;
    orl_job_output_path(worker->output, name, path);
    return read_chunk(path, chunk);
}

/* ---- Progress ------------------------------------------------------------------------------- */

static void on_round(void *ctx, const struct orl_annual_refinement *so_far)
{
    struct orl_worker *worker = ctx;
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.year = *so_far;
    pthread_mutex_unlock(&worker->news_mutex);
}

static void add_tally(struct orl_worker *worker, const struct orl_annual_result *result)
{
    static const enum orl_stage stages[ORL_ANNUAL_STAGES] = {
        [ORL_ANNUAL_LOAD] = ORL_STAGE_LOAD,    [ORL_ANNUAL_SKIES] = ORL_STAGE_MAPS,
        [ORL_ANNUAL_PATHS] = ORL_STAGE_RENDER, [ORL_ANNUAL_SUN] = ORL_STAGE_RENDER,
        [ORL_ANNUAL_HOURS] = ORL_STAGE_RENDER,
    };
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        worker->outcome.tally.stages_s[stages[i]] += result->timings_s[i];
    orl_health_add(&worker->outcome.tally.health, &result->health);
}

static int on_end(void *ctx, const struct orl_annual_result *result,
                  const struct orl_annual_report *report, json_t *document, const json_t *names,
                  struct orl_error *err)
{
    struct orl_worker *worker = ctx;
    (void)report;
    add_tally(worker, result);
    return orl_annual_output_write(document, names, worker->output, &worker->outcome.summary, err);
}

/* ---- The job --------------------------------------------------------------------------------- */

/* Data of a larger annual job would displace too much else from the cache. */
enum { KEPT_SENSORS = 2000 };

int orl_worker_run_annual(struct orl_worker *worker, struct orl_job_request *job_request,
                          const struct orl_files *files, struct orl_error *err)
{
    const struct orl_run_env run = orl_worker_env(worker, files);
    const bool here =
        !worker->progress.in_parts; /* otherwise its parts are stored in the shared folder */
    const struct orl_annual_job_env env = {.run = &run,
                                           .reuse = here,
                                           .reuse_most = KEPT_SENSORS,
                                           .restored = here ? on_kept : NULL,
                                           .done = here ? on_done : NULL,
                                           .round = on_round,
                                           .on_result = on_end};
    return orl_annual_job_run(&job_request->of.annual, &env, err);
}
