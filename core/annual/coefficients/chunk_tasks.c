#include "annual/coefficients/chunk_tasks.h"

#include <stdlib.h>
#include <string.h>

size_t orl_year_chunk_of_tasks(size_t n_sensors, size_t most)
{
    enum { CHUNKS = 2000, LEAST = 8 };
    const size_t size = n_sensors / CHUNKS;
    return size < LEAST ? LEAST : size < most ? size : most;
}

static void select_chunk(struct orl_year *y, size_t index)
{
    const size_t n = y->request->n_sensors;
    y->first = index * y->chunk;
    y->count = n - y->first < y->chunk ? n - y->first : y->chunk;
}

/* Time of a path with its sunlight, in a room of a dozen surfaces. */
static const double path_s = 1e-5;

/* Estimated time of the current chunk, in seconds of one core. */
static double chunk_core_s(const struct orl_year *y)
{
    return path_s * (double)y->count * (double)y->batch_samples * ORL_ANNUAL_BATCHES;
}

/* Memory of the sums of all batches of the current chunk. */
static uint64_t chunk_bytes(const struct orl_year *y)
{
    const struct orl_chunk_sums *sums = &y->sums;
    const uint64_t of_light = sums->n_nodes * sizeof *sums->nodes + ORL_BINS * sizeof *sums->bins;
    const uint64_t of_batch =
        y->n_window_groups * of_light +
        sums->n_beams *
            (sizeof *sums->beams + ORL_SUN_PHOTON_BATCHES * sizeof *sums->photon_batches);
    return of_batch * y->count * ORL_ANNUAL_BATCHES;
}

/* Returns true if the store has all of the current chunk. The task's key is that of its rows or
 * paths. */
static bool is_stored(struct orl_year *y, struct orl_job_task *ret_piece)
{
    struct orl_annual_cache_entry paths = {.data_kind = y->shares_rows ? ORL_ANNUAL_CACHE_ROWS
                                                                       : ORL_ANNUAL_CACHE_PATHS,
                                           .first = y->first,
                                           .count = y->count,
                                           .samples = y->result->samples},
                                  sun = {.data_kind = ORL_ANNUAL_CACHE_SUNLIGHT,
                                         .first = y->first,
                                         .count = y->count};
    const bool has_paths = orl_annual_cache_has(&y->cache, &paths);
    const bool has_sun = y->shares_rows || orl_annual_cache_has(&y->cache, &sun);
    *ret_piece = (struct orl_job_task){.kind = "rows",
                                       .work = (double)y->count,
                                       .core_s = chunk_core_s(y),
                                       .bytes = chunk_bytes(y)};
    memcpy(ret_piece->key, paths.key, sizeof ret_piece->key);
    return has_paths && has_sun;
}

/* Lists the missing chunks with their indices, and returns their number. */
static size_t list_missing(struct orl_year *y, size_t n, struct orl_job_task *tasks,
                           size_t *indices)
{
    size_t missing = 0;
    for (size_t i = 0; i < n; i++) {
        select_chunk(y, i);
        indices[missing] = i;
        missing += !is_stored(y, &tasks[missing]);
    }
    return missing;
}

struct missing {
    struct orl_job_task *tasks;
    size_t *indices;
    bool *here;
};

static void report_share(void *ctx, double share)
{
    struct orl_year *y = ctx;
    orl_year_report_progress(y, ORL_STAGE_RENDER, share * (double)y->request->n_sensors);
}

/* Divides chunks among processes until the store has all, or no more can be stored. */
static int divide_missing(struct orl_year *y, size_t n, const struct missing *w,
                          orl_year_compute_chunk *make, struct orl_error *err)
{
    const struct orl_job_tasks *shared = y->env->run->tasks;
    const struct orl_job_tasks_watch watch = {report_share, y};
    size_t missing = list_missing(y, n, w->tasks, w->indices), before = n + 1;
    int code = 0;
    while (code == 0 && missing > 0 && missing < before) {
        before = missing;
        memset(w->here, 0, n * sizeof *w->here);
        code = shared->claim(shared->ctx, w->tasks, missing, w->here, &watch, err);
        for (size_t i = 0; i < missing && code == 0; i++) {
            select_chunk(y, w->indices[i]);
            code = w->here[i] ? make(y, err) : 0;
        }
        if (code == 0 && orl_job_tasks_should_stop(shared))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "all that is wanted of the run is made");
        if (code == 0)
            missing = list_missing(y, n, w->tasks, w->indices);
    }
    return code;
}

int orl_year_run_chunk_tasks(struct orl_year *y, orl_year_compute_chunk *make,
                             struct orl_error *err)
{
    const size_t n = (y->request->n_sensors + y->chunk - 1) / y->chunk;
    const struct missing w = {.tasks = calloc(n + 1, sizeof *w.tasks),
                              .indices = calloc(n + 1, sizeof *w.indices),
                              .here = calloc(n + 1, sizeof *w.here)};
    const int code = w.tasks && w.indices && w.here ? divide_missing(y, n, &w, make, err)
                                                    : orl_year_no_memory(err);
    free(w.tasks);
    free(w.indices);
    free(w.here);
    return code;
}
