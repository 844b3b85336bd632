/* Chunks of a year's sensors, computed here or distributed among processes. */
#include "annual/coefficients/sensor_chunks.h"

#include <stdlib.h>
#include <string.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/sun/sunlight.h"
#include "annual/year/annual_year.h"
#include "scene/geometry/geometry.h"

/*
 * Chunks of a year's sensors as tasks of a distributed run (oriel/job/job_tasks.h). The store
 * holds the rows of each chunk. If rows cannot be shared, it holds their paths and the direct
 * sunlight at their sensors.
 */

static int compute_chunk(struct orl_year *y, struct orl_error *err);

static void select_chunk(struct orl_year *y, size_t index)
{
    struct orl_year_chunk *c = &y->chunk;
    const size_t n = y->request->n_sensors;
    c->first = index * c->size;
    c->count = n - c->first < c->size ? n - c->first : c->size;
}

/* Memory of the sums of all batches of the current chunk. */
static uint64_t chunk_bytes(const struct orl_year *y)
{
    const struct orl_chunk_sums *sums = &y->chunk.sums;
    const uint64_t of_light = sums->n_nodes * sizeof *sums->nodes + ORL_BINS * sizeof *sums->bins;
    const uint64_t of_batch =
        y->n_window_groups * of_light +
        sums->n_beams *
            (sizeof *sums->beams + ORL_SUN_PHOTON_BATCHES * sizeof *sums->photon_batches);
    return of_batch * y->chunk.count * ORL_ANNUAL_BATCHES;
}

static struct orl_annual_cache_entry entry_of(const struct orl_year *y, unsigned data_kind)
{
    return (struct orl_annual_cache_entry){
        .data_kind = data_kind,
        .first = y->chunk.first,
        .count = y->chunk.count,
        .samples = data_kind == ORL_ANNUAL_CACHE_SUNLIGHT ? 0 : y->result->samples};
}

/* Returns true if the store has all of the current chunk. The task's key is that of its rows or
 * paths. */
static bool is_stored(struct orl_year *y, struct orl_job_task *ret_piece)
{
    static const double path_s = 1e-5; /* with its sunlight, in a room of a dozen surfaces */
    struct orl_annual_cache_entry sun = entry_of(y, ORL_ANNUAL_CACHE_SUNLIGHT);
    struct orl_annual_cache_entry paths =
        entry_of(y, y->chunk.shares_rows ? ORL_ANNUAL_CACHE_ROWS : ORL_ANNUAL_CACHE_PATHS);
    const bool has_paths = orl_annual_cache_has(&y->cache, &paths);
    const bool has_sun = y->chunk.shares_rows || orl_annual_cache_has(&y->cache, &sun);
    *ret_piece = (struct orl_job_task){.kind = "rows",
                                       .work = (double)y->chunk.count,
                                       .core_s = path_s * (double)y->chunk.count *
                                                 (double)y->batch_samples * ORL_ANNUAL_BATCHES,
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

/* Distributes chunks among processes until the store has all, or no more can be stored. */
static int divide_missing(struct orl_year *y, size_t n, const struct missing *w,
                          struct orl_error *err)
{
    const struct orl_job_tasks *shared = y->env->run->tasks;
    const struct orl_job_tasks_watch watch = {report_share, y};
    size_t missing = list_missing(y, n, w->tasks, w->indices), before = n + 1;
    int code = 0;
    while (code == 0 && missing > 0 && missing < before) {
        before = missing;
        memset(w->here, 0, n * sizeof *w->here);
        code = orl_job_tasks_claim(shared, w->tasks, missing, w->here, &watch, err);
        for (size_t i = 0; i < missing && code == 0; i++) {
            select_chunk(y, w->indices[i]);
            code = w->here[i] ? compute_chunk(y, err) : 0;
        }
        if (code == 0 && orl_job_tasks_should_stop(shared))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "all requested parts of the run are done");
        if (code == 0)
            missing = list_missing(y, n, w->tasks, w->indices);
    }
    return code;
}

/* Distributes chunks among processes until the store has all of them. Chunks that cannot be stored
 * are computed later, chunk by chunk. */
static int run_chunk_tasks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = (y->request->n_sensors + y->chunk.size - 1) / y->chunk.size;
    const struct missing w = {.tasks = orl_arrays_new(&y->arrays, n, sizeof *w.tasks),
                              .indices = orl_arrays_new(&y->arrays, n, sizeof *w.indices),
                              .here = orl_arrays_new(&y->arrays, n, sizeof *w.here)};
    return y->arrays.failed ? orl_year_no_memory(err) : divide_missing(y, n, &w, err);
}

#define TRACING 0.85 /* approximate share of a chunk's time */

/* ---- Chunks ---------------------------------------------------------------------------------- */

/* Returns true if the year reports direct sunlight by window group and makes no rows. */
static bool reports_sunlight(const struct orl_year *y)
{
    return y->overrides->sun_only && y->overrides->window_groups;
}

static void trace_batch(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const size_t sensor = index / ORL_ANNUAL_BATCHES;
    const struct orl_annual_batch batch = {.seed = y->request->seed,
                                           .sensor = y->chunk.first + sensor,
                                           .batch = (uint32_t)(index % ORL_ANNUAL_BATCHES),
                                           .first = y->chunk.traced_before,
                                           .samples = y->batch_samples,
                                           .pool = y->env->run->pool};
    struct orl_path_sums sums = orl_chunk_sums_of(&y->chunk.sums, sensor, batch.batch);
    orl_annual_trace(&y->scene, &y->chunk.places[sensor], &batch, &sums, &y->chunk.healths[member]);
    const double whole = (double)(y->chunk.count * ORL_ANNUAL_BATCHES);
    const double done = (double)(atomic_fetch_add(&y->chunk.traced, 1) + 1);
    if (member == 0) /* the lead thread */
        orl_year_report_progress(y, ORL_STAGE_RENDER,
                                 (double)y->chunk.first +
                                     TRACING * (double)y->chunk.count * done / whole);
}

static void find_sensor_sunlight(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    struct orl_sensor_sunlight rows = orl_chunk_suns_of(&y->chunk.sums, index);
    const uint64_t name = y->request->seed + y->chunk.first + index;
    (void)member;
    rows.direct_only = y->overrides->sun_only;
    rows.disc_points = orl_disc_points(y->request->samples);
    rows.wanted = y->chunk.wanted_suns;
    orl_sunlight_find_hours(&y->scene, &y->hours.suns, &y->chunk.places[index], name,
                            y->env->run->pool, &rows);
    if (y->has_bsdf_panes)
        orl_bsdf_panes_add(&y->bsdf_panes, &y->chunk.places[index], name, y->env->run->pool, &rows);
}

/* Places the chunk's sensors. Refuses sensors outdoors if light is split by window group, because
 * their light enters through no window. */
static int place_sensors(struct orl_year *y, struct orl_error *err)
{
    for (size_t i = 0; i < y->chunk.count; i++) {
        const struct orl_sensor *sensor = &y->request->sensors[y->chunk.first + i];
        struct orl_shading_point *place = &y->chunk.places[i];
        *place = orl_year_place_of(y, sensor);
        place->outside = orl_lit_scene_is_outside(y->lit_scene, place->point);
        if (place->outside && y->overrides->window_groups)
            return orl_error_set(
                err, ORL_ERR_UNSUPPORTED,
                "sensor %zu is outdoors: its light cannot be separated by window groups",
                y->chunk.first + i + 1);
    }
    return 0;
}

static int deliver_rows(struct orl_year *y, struct orl_error *err)
{
    const size_t columns = y->hours.n_columns, bytes = columns * sizeof(float);
    for (size_t i = 0; i < y->chunk.count; i++) {
        const size_t sensor = y->chunk.first + i;
        const float *total = orl_year_row_of(y, i, ORL_YEAR_TOTAL),
                    *direct = orl_year_row_of(y, i, ORL_YEAR_DIRECT);
        const float *se = orl_year_row_of(y, i, ORL_YEAR_SE);
        if (y->env->row) {
            const int code = y->env->row(y->env->ctx, sensor, total, direct, se, err);
            if (code < 0)
                return code;
            continue;
        }
        memcpy(y->result->total + sensor * columns, total, bytes);
        memcpy(y->result->direct + sensor * columns, direct, bytes);
        memcpy(y->result->se + sensor * columns, se, bytes);
    }
    return 0;
}

/* ---- Sums and rows, stored or computed ------------------------------------------------------- */

static uint64_t count_rays(const struct orl_year *y)
{
    uint64_t rays = 0;
    for (uint32_t i = 0; i < orl_thread_pool_size(y->env->run->pool); i++)
        rays += y->chunk.healths[i].rays;
    return rays;
}

static int trace_paths(struct orl_year *y, struct orl_annual_cache_entry *entry,
                       struct orl_error *err)
{
    const uint64_t before = count_rays(y);
    int code = orl_year_ensure_scene(y, err);
    if (code == 0)
        code = place_sensors(y, err);
    if (code < 0)
        return code;
    y->chunk.traced_before = entry->stored_samples / ORL_ANNUAL_BATCHES;
    atomic_store(&y->chunk.traced, 0);
    code = orl_parallel_try(y->env->run->pool, y->chunk.count * ORL_ANNUAL_BATCHES, trace_batch, y);
    entry->rays += count_rays(y) - before;
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

static int compute_sunlight(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_ensure_bsdf_panes(y, err);
    if (code == 0)
        code = place_sensors(y, err);
    if (code < 0)
        return code;
    code = orl_parallel_try(y->env->run->pool, y->chunk.count, find_sensor_sunlight, y);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

/* Gets a part of the chunk's sums from the store. Computes and stores it, or the samples of paths
 * that are missing. If runs share rows, the store has no parts. */
static int get_part(struct orl_year *y, enum orl_chunk_part part, struct orl_error *err)
{
    const bool paths = part == ORL_CHUNK_PATHS;
    struct orl_annual_cache_entry entry =
        entry_of(y, paths ? ORL_ANNUAL_CACHE_PATHS : ORL_ANNUAL_CACHE_SUNLIGHT);
    int code = y->chunk.shares_rows ? 0 : orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    const bool found =
        orl_chunk_sums_unpack(&y->chunk.sums, part, y->chunk.count, entry.data, entry.size);
    if (!found)
        entry.stored_samples = 0;
    if (paths && entry.stored_samples < entry.samples)
        code = trace_paths(y, &entry, err);
    else if (!paths && !found)
        code = compute_sunlight(y, err);
    if (code == 0 && entry.must_commit) {
        size_t size = 0;
        void *data = orl_chunk_sums_pack(&y->chunk.sums, part, y->chunk.count, &size);
        orl_annual_cache_put(&y->cache, &entry, data, size);
    }
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

static void report_sunlight(const struct orl_year *y)
{
    const struct orl_year_window_groups *window_groups = y->overrides->window_groups;
    for (size_t i = 0; i < y->chunk.count; i++)
        for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++)
            if (orl_chunk_suns_of(&y->chunk.sums, i).lit[window_group]) {
                orl_chunk_direct_sunlight(y, i, window_group, y->chunk.rows);
                window_groups->sunlit(window_groups->ctx, y->chunk.first + i, window_group,
                                      y->chunk.rows);
            }
}

/* Computes direct sunlight alone, and reports it by window group or as rows. */
static int run_sun_only(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_ensure_bsdf_panes(y, err);
    double since = orl_year_now(y);
    if (code < 0)
        return code;
    orl_chunk_sums_clear(&y->chunk.sums, ORL_CHUNK_SUNS, y->chunk.count);
    code = compute_sunlight(y, err);
    orl_year_add_timing(y, ORL_ANNUAL_SUN, &since);
    if (code == 0 && reports_sunlight(y))
        report_sunlight(y);
    if (code < 0 || reports_sunlight(y))
        return code;
    memset(y->chunk.rows, 0,
           y->chunk.count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->chunk.rows);
    for (size_t i = 0; i < y->chunk.count; i++)
        orl_chunk_direct_sunlight(y, i, 0, orl_year_row_of(y, i, ORL_YEAR_DIRECT));
    return deliver_rows(y, err);
}

/* Computes the rows from paths and suns. */
static int compute_rows(struct orl_year *y, struct orl_error *err)
{
    double since = orl_year_now(y);
    int code = get_part(y, ORL_CHUNK_PATHS, err);
    orl_year_add_timing(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = get_part(y, ORL_CHUNK_SUNS, err);
    orl_year_add_timing(y, ORL_ANNUAL_SUN, &since);
    if (code < 0)
        return code;
    code = orl_chunk_rows_compute(y);
    orl_year_add_timing(y, ORL_ANNUAL_HOURS, &since);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

enum { ROW_ARRAYS = 4 };

/* Lists the arrays stored for a chunk: rows, the light of the overcast sky with its error, and
 * coherence. */
static void list_row_arrays(const struct orl_year *y, struct orl_span ret[ROW_ARRAYS])
{
    const struct orl_annual_result *r = y->result;
    const size_t first = y->chunk.first, count = y->chunk.count;
    ret[0] = (struct orl_span){y->chunk.rows,
                               count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->chunk.rows};
    ret[1] = (struct orl_span){r->overcast + first, count * sizeof *r->overcast};
    ret[2] = (struct orl_span){r->overcast_se + first, count * sizeof *r->overcast_se};
    ret[3] = (struct orl_span){r->coherence + first, count * sizeof *r->coherence};
}

/* Computes the rows; if runs share the year, takes them from the store where possible. */
static int get_rows(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = entry_of(y, ORL_ANNUAL_CACHE_ROWS);
    struct orl_span arrays[ROW_ARRAYS];
    if (!y->chunk.shares_rows)
        return compute_rows(y, err);
    int code = orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    list_row_arrays(y, arrays);
    if (!orl_spans_fill(arrays, ROW_ARRAYS, entry.data, entry.size))
        code = compute_rows(y, err);
    if (code == 0 && entry.must_commit) {
        size_t size = 0;
        void *data = orl_spans_join(arrays, ROW_ARRAYS, &size);
        orl_annual_cache_put(&y->cache, &entry, data, size);
    }
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

static int run_chunk(struct orl_year *y, struct orl_error *err)
{
    if (y->overrides->sun_only)
        return run_sun_only(y, err);
    int code = get_rows(y, err);
    double since = orl_year_now(y);
    if (code == 0)
        code = deliver_rows(y, err);
    orl_year_add_timing(y, ORL_ANNUAL_HOURS, &since);
    return code;
}

static int allocate_result(struct orl_year *y)
{
    const size_t columns = y->hours.n_columns, n = y->request->n_sensors;
    struct orl_annual_result *r = y->result;
    y->chunk.healths = orl_arrays_new(&y->arrays, orl_thread_pool_size(y->env->run->pool),
                                      sizeof *y->chunk.healths);
    if (orl_chunk_rows_init(y) < 0)
        return ORL_ERR_NOMEM;
    orl_overcast_init(&y->overcast, &y->bins, y->request->ground_reflectance);
    r->overcast = calloc(n + 1, sizeof *r->overcast);
    r->overcast_se = calloc(n + 1, sizeof *r->overcast_se);
    r->coherence = calloc(n + 1, sizeof *r->coherence);
    if (!r->overcast || !r->overcast_se || !r->coherence)
        return ORL_ERR_NOMEM;
    if (y->request->coefficients) {
        r->coefficients = calloc(n * ORL_ANNUAL_PATCHES + 1, sizeof *r->coefficients);
        if (!r->coefficients)
            return ORL_ERR_NOMEM;
    }
    if (y->env->row || reports_sunlight(y))
        return 0;
    r->total = malloc((n * columns + 1) * sizeof *r->total);
    r->direct = malloc((n * columns + 1) * sizeof *r->direct);
    r->se = malloc((n * columns + 1) * sizeof *r->se);
    return r->total && r->direct && r->se ? 0 : ORL_ERR_NOMEM;
}

/* ---- Stored chunks --------------------------------------------------------------------------- */

/* Returns the current chunk as a part of the result's arrays, which must exist. */
static struct orl_annual_chunk chunk_of(const struct orl_year *y)
{
    const struct orl_annual_result *r = y->result;
    const size_t columns = y->hours.n_columns, at = y->chunk.first * columns;
    return (struct orl_annual_chunk){.round = y->env->round,
                                     .first = y->chunk.first,
                                     .count = y->chunk.count,
                                     .n_columns = columns,
                                     .total = r->total + at,
                                     .direct = r->direct + at,
                                     .se = r->se + at,
                                     .overcast = r->overcast + y->chunk.first,
                                     .overcast_se = r->overcast_se + y->chunk.first,
                                     .coherence = r->coherence + y->chunk.first};
}

static bool is_restored(struct orl_year *y)
{
    if (reports_sunlight(y) || y->env->row || !y->env->restored || y->result->coefficients)
        return false; /* coefficients are stored in no chunk */
    struct orl_annual_chunk chunk = chunk_of(y);
    return y->env->restored(y->env->ctx, &chunk);
}

static void report_chunk_done(const struct orl_year *y)
{
    if (reports_sunlight(y) || y->env->row || !y->env->done)
        return;
    const struct orl_annual_chunk chunk = chunk_of(y);
    y->env->done(y->env->ctx, &chunk);
}

/* Computes what distributed runs share of a chunk: its rows, or its paths and sunlight. */
static int compute_chunk(struct orl_year *y, struct orl_error *err)
{
    if (y->chunk.shares_rows)
        return get_rows(y, err);
    const int code = get_part(y, ORL_CHUNK_PATHS, err);
    return code == 0 ? get_part(y, ORL_CHUNK_SUNS, err) : code;
}

/* ---- All chunks ------------------------------------------------------------------------------ */

/* Number of sensors per chunk, such that a tile has at most LIGHTS pairs of a window group and a
 * sensor. If processes share chunks, it is small enough to give each of a thousand several chunks.
 * Results do not depend on it. */
static size_t sensors_per_chunk(const struct orl_year *y, bool shared)
{
    enum { LIGHTS = 256, LEAST = 8, CHUNKS = 2000 };
    size_t size = LIGHTS / y->n_window_groups;
    if (size > ORL_YEAR_CHUNK)
        size = ORL_YEAR_CHUNK;
    if (shared && size > y->request->n_sensors / CHUNKS)
        size = y->request->n_sensors / CHUNKS;
    return size < LEAST ? LEAST : size;
}

int orl_year_run_chunks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = y->request->n_sensors;
    const bool shared = y->env->run->tasks && y->cache.store && !y->overrides->sun_only;
    y->chunk.size = sensors_per_chunk(y, shared);
    int code = allocate_result(y) < 0 ? orl_year_no_memory(err) : 0;
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    y->chunks_s = orl_year_now(y);
    /* Rows have no coefficients; with coefficients, runs share the paths of chunks instead. */
    y->chunk.shares_rows = shared && !y->result->coefficients;
    if (code == 0 && shared)
        code = run_chunk_tasks(y, err);
    for (size_t i = 0; i * y->chunk.size < n && code == 0; i++) {
        select_chunk(y, i);
        if (is_restored(y)) {
            y->restored += y->chunk.count;
            continue;
        }
        code = run_chunk(y, err);
        if (code == 0)
            report_chunk_done(y);
        orl_year_report_progress(y, ORL_STAGE_RENDER, (double)(y->chunk.first + y->chunk.count));
    }
    for (uint32_t i = 0; y->chunk.healths && i < orl_thread_pool_size(y->env->run->pool); i++)
        orl_health_add(&y->result->health, &y->chunk.healths[i]);
    return code;
}
