/*
 * Chunks of a year's sensors, computed here or distributed among processes: paths, direct
 * sunlight, and their products with all hours.
 */
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

/* Computes the current chunk (first, count), and stores it. */
typedef int orl_year_compute_chunk(struct orl_year *y, struct orl_error *err);

/* Returns the number of sensors per chunk: small enough to give each of a thousand processes
 * several chunks, at least 8 and at most `most`. Results do not depend on it. */
static size_t orl_year_chunk_of_tasks(size_t n_sensors, size_t most)
{
    enum { CHUNKS = 2000, LEAST = 8 };
    const size_t size = n_sensors / CHUNKS;
    return size < LEAST ? LEAST : size < most ? size : most;
}

static void select_chunk(struct orl_year *y, size_t index)
{
    const size_t n = y->request->n_sensors;
    y->first = index * y->chunk_size;
    y->count = n - y->first < y->chunk_size ? n - y->first : y->chunk_size;
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

/* Distributes chunks among processes until the store has all, or no more can be stored. */
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
            code = orl_error_set(err, ORL_ERR_CANCELLED, "all requested parts of the run are done");
        if (code == 0)
            missing = list_missing(y, n, w->tasks, w->indices);
    }
    return code;
}

/* Distributes chunks among processes until the store has all of them. Chunks that cannot be stored
 * are computed later, chunk by chunk. */
static int orl_year_run_chunk_tasks(struct orl_year *y, orl_year_compute_chunk *make,
                                    struct orl_error *err)
{
    const size_t n = (y->request->n_sensors + y->chunk_size - 1) / y->chunk_size;
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

/* Rows of a chunk of sensors: paths, direct sunlight, and their products with all hours. */

#define TRACING 0.85 /* approximate share of a chunk's time */

/* ---- Chunks ---------------------------------------------------------------------------------- */

/* Returns true if the year reports direct sunlight by window group and makes no rows. */
static bool reports_sunlight(const struct orl_year *y)
{
    return orl_year_is_sun_only(y) && y->overrides->window_groups;
}

static void trace_batch(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const size_t sensor = index / ORL_ANNUAL_BATCHES;
    const struct orl_annual_batch batch = {.seed = y->request->seed,
                                           .sensor = y->first + sensor,
                                           .batch = (uint32_t)(index % ORL_ANNUAL_BATCHES),
                                           .first = y->traced_before,
                                           .samples = y->batch_samples,
                                           .pool = y->env->run->pool};
    struct orl_path_sums sums = orl_chunk_sums_of(&y->sums, sensor, batch.batch);
    orl_annual_trace(&y->scene, &y->places[sensor], &batch, &sums, &y->healths[member]);
    const double whole = (double)(y->count * ORL_ANNUAL_BATCHES);
    const double done = (double)(atomic_fetch_add(&y->traced, 1) + 1);
    if (member == 0) /* the lead thread */
        orl_year_report_progress(y, ORL_STAGE_RENDER,
                                 (double)y->first + TRACING * (double)y->count * done / whole);
}

static void find_sensor_sunlight(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    struct orl_sensor_sunlight rows = orl_chunk_suns_of(&y->sums, index);
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    rows.direct_only = orl_year_is_sun_only(y);
    rows.disc_points = orl_disc_points(y->request->samples);
    rows.wanted = y->wanted_suns;
    orl_sunlight_find_hours(&y->scene, &y->hours.suns, &y->places[index], name, y->env->run->pool,
                            &rows);
    if (y->has_bsdf_panes)
        orl_bsdf_panes_add(&y->bsdf_panes, &y->places[index], name, y->env->run->pool, &rows);
}

static void place_sensors(struct orl_year *y)
{
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_sensor *sensor = &y->request->sensors[y->first + i];
        const struct orl_vec3 normal = orl_normalize(sensor->direction);
        const struct orl_vec3 at = orl_sub(sensor->position, y->lit_scene->geometry->center);
        struct orl_shading_point *place = &y->places[i];
        *place = (struct orl_shading_point){
            .point = orl_offset_from_surface(y->lit_scene->geometry, at, normal), .normal = normal};
        place->outside = orl_lit_scene_is_outside(y->lit_scene, place->point);
    }
}

static int deliver_rows(struct orl_year *y, struct orl_error *err)
{
    const size_t columns = y->hours.n_columns, bytes = columns * sizeof(float);
    for (size_t i = 0; i < y->count; i++) {
        const size_t sensor = y->first + i;
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

/* Stores packed data, unless packing ran out of memory (code < 0), and frees it. */
static void store_packed(struct orl_year *y, struct orl_annual_cache_entry *entry, int code,
                         void *data, size_t size)
{
    if (code == 0)
        orl_annual_cache_put(&y->cache, entry, data, size);
    free(data);
}

static uint64_t count_rays(const struct orl_year *y)
{
    uint64_t rays = 0;
    for (uint32_t i = 0; i < orl_thread_pool_size(y->env->run->pool); i++)
        rays += y->healths[i].rays;
    return rays;
}

/* Refuses sensors outdoors if light is split by window group, because their light enters through no
 * window. */
static int check_places(const struct orl_year *y, struct orl_error *err)
{
    if (!y->overrides || !y->overrides->window_groups)
        return 0;
    for (size_t i = 0; i < y->count; i++)
        if (y->places[i].outside)
            return orl_error_set(
                err, ORL_ERR_UNSUPPORTED,
                "sensor %zu is outdoors: its light cannot be separated by window groups",
                y->first + i + 1);
    return 0;
}

static int trace_paths(struct orl_year *y, struct orl_annual_cache_entry *entry,
                       struct orl_error *err)
{
    const uint64_t before = count_rays(y);
    int code = orl_year_ensure_scene(y, err);
    if (code < 0)
        return code;
    place_sensors(y);
    code = check_places(y, err);
    if (code < 0)
        return code;
    y->traced_before = entry->stored_samples / ORL_ANNUAL_BATCHES;
    atomic_store(&y->traced, 0);
    code = orl_parallel_try(y->env->run->pool, y->count * ORL_ANNUAL_BATCHES, trace_batch, y);
    entry->rays += count_rays(y) - before;
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

static int get_paths(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = {.data_kind = ORL_ANNUAL_CACHE_PATHS,
                                           .first = y->first,
                                           .count = y->count,
                                           .samples = y->result->samples};
    void *data = NULL;
    size_t size = 0;
    int code = y->shares_rows ? 0 : orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    if (!orl_chunk_sums_unpack_paths(&y->sums, y->count, entry.data, entry.size))
        entry.stored_samples = 0;
    if (entry.stored_samples < entry.samples)
        code = trace_paths(y, &entry, err);
    if (code == 0 && entry.must_commit) {
        const int packed = orl_chunk_sums_pack_paths(&y->sums, y->count, &data, &size);
        store_packed(y, &entry, packed, data, size);
    }
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

static int compute_sunlight(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_ensure_bsdf_panes(y, err);
    if (code < 0)
        return code;
    place_sensors(y);
    code = orl_parallel_try(y->env->run->pool, y->count, find_sensor_sunlight, y);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

static int get_sunlight(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = {
        .data_kind = ORL_ANNUAL_CACHE_SUNLIGHT, .first = y->first, .count = y->count};
    void *data = NULL;
    size_t size = 0;
    int code = y->shares_rows ? 0 : orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    if (!orl_chunk_sums_unpack_suns(&y->sums, y->count, entry.data, entry.size))
        code = compute_sunlight(y, err);
    if (code == 0 && entry.must_commit) {
        const int packed = orl_chunk_sums_pack_suns(&y->sums, y->count, &data, &size);
        store_packed(y, &entry, packed, data, size);
    }
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

static void report_sunlight(const struct orl_year *y)
{
    const struct orl_year_window_groups *window_groups = y->overrides->window_groups;
    for (size_t i = 0; i < y->count; i++)
        for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++)
            if (orl_chunk_suns_of(&y->sums, i).lit[window_group]) {
                orl_chunk_direct_sunlight(y, i, window_group, y->rows);
                window_groups->sunlit(window_groups->ctx, y->first + i, window_group, y->rows);
            }
}

/* Computes direct sunlight alone, and reports it by window group or as rows. */
static int run_sun_only(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_ensure_bsdf_panes(y, err);
    double since = orl_year_now(y);
    if (code < 0)
        return code;
    place_sensors(y);
    code = check_places(y, err);
    orl_chunk_sums_clear_suns(&y->sums, y->count);
    if (code == 0 && orl_parallel_try(y->env->run->pool, y->count, find_sensor_sunlight, y) < 0)
        code = orl_year_cancelled(err);
    orl_year_add_timing(y, ORL_ANNUAL_SUN, &since);
    if (code == 0 && reports_sunlight(y))
        report_sunlight(y);
    if (code < 0 || reports_sunlight(y))
        return code;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    for (size_t i = 0; i < y->count; i++)
        orl_chunk_direct_sunlight(y, i, 0, orl_year_row_of(y, i, ORL_YEAR_DIRECT));
    return deliver_rows(y, err);
}

/* Computes the rows from paths and suns. */
static int compute_rows(struct orl_year *y, struct orl_error *err)
{
    double since = orl_year_now(y);
    int code = get_paths(y, err);
    orl_year_add_timing(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = get_sunlight(y, err);
    orl_year_add_timing(y, ORL_ANNUAL_SUN, &since);
    if (code < 0)
        return code;
    code = orl_chunk_rows_compute(y);
    orl_year_add_timing(y, ORL_ANNUAL_HOURS, &since);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

enum { ROW_ARRAYS = 4 };
struct array {
    void *at;
    size_t bytes;
};

/* Lists the arrays stored for a chunk: rows, the light of the overcast sky with its error, and
 * coherence. */
static size_t list_row_arrays(const struct orl_year *y, struct array ret[ROW_ARRAYS])
{
    const struct orl_annual_result *r = y->result;
    ret[0] =
        (struct array){y->rows, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows};
    ret[1] = (struct array){r->overcast + y->first, y->count * sizeof *r->overcast};
    ret[2] = (struct array){r->overcast_se + y->first, y->count * sizeof *r->overcast_se};
    ret[3] = (struct array){r->coherence + y->first, y->count * sizeof *r->coherence};
    return ret[0].bytes + ret[1].bytes + ret[2].bytes + ret[3].bytes;
}

static bool load_rows(const struct orl_year *y, const struct orl_annual_cache_entry *entry)
{
    struct array arrays[ROW_ARRAYS];
    const char *from = entry->data;
    if (!from || entry->size != list_row_arrays(y, arrays))
        return false;
    for (int i = 0; i < ROW_ARRAYS; from += arrays[i++].bytes)
        memcpy(arrays[i].at, from, arrays[i].bytes);
    return true;
}

static void store_rows(struct orl_year *y, struct orl_annual_cache_entry *entry)
{
    struct array arrays[ROW_ARRAYS];
    const size_t size = list_row_arrays(y, arrays);
    char *data = malloc(size + 1), *to = data;
    for (int i = 0; data && i < ROW_ARRAYS; to += arrays[i++].bytes)
        memcpy(to, arrays[i].at, arrays[i].bytes);
    store_packed(y, entry, data ? 0 : ORL_ERR_NOMEM, data, size);
}

/* Computes the rows; if runs share the year, takes them from the store where possible. */
static int get_rows(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = {.data_kind = ORL_ANNUAL_CACHE_ROWS,
                                           .first = y->first,
                                           .count = y->count,
                                           .samples = y->result->samples};
    if (!y->shares_rows)
        return compute_rows(y, err);
    int code = orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    if (!load_rows(y, &entry))
        code = compute_rows(y, err);
    if (code == 0 && entry.must_commit)
        store_rows(y, &entry);
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

static int run_chunk(struct orl_year *y, struct orl_error *err)
{
    if (orl_year_is_sun_only(y))
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
    y->healths = calloc(orl_thread_pool_size(y->env->run->pool), sizeof *y->healths);
    if (orl_chunk_rows_init(y) < 0 || !y->healths)
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
    const size_t columns = y->hours.n_columns, at = y->first * columns;
    return (struct orl_annual_chunk){.round = y->env->round,
                                     .first = y->first,
                                     .count = y->count,
                                     .n_columns = columns,
                                     .total = r->total + at,
                                     .direct = r->direct + at,
                                     .se = r->se + at,
                                     .overcast = r->overcast + y->first,
                                     .overcast_se = r->overcast_se + y->first,
                                     .coherence = r->coherence + y->first};
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
    if (y->shares_rows)
        return get_rows(y, err);
    const int code = get_paths(y, err);
    return code == 0 ? get_sunlight(y, err) : code;
}

/* ---- All chunks ------------------------------------------------------------------------------ */

/* Number of sensors per chunk, such that a tile has at most LIGHTS pairs of a window group and a
 * sensor. */
static size_t most_sensors_per_chunk(const struct orl_year *y)
{
    enum { LIGHTS = 256, LEAST = 8 };
    const size_t most = LIGHTS / y->n_window_groups;
    return most < LEAST ? LEAST : most < ORL_YEAR_CHUNK ? most : ORL_YEAR_CHUNK;
}

int orl_year_run_chunks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = y->request->n_sensors, most = most_sensors_per_chunk(y);
    const bool shared = y->env->run->tasks && y->cache.store && !orl_year_is_sun_only(y);
    y->chunk_size = shared ? orl_year_chunk_of_tasks(n, most) : most;
    int code = allocate_result(y) < 0 ? orl_year_no_memory(err) : 0;
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    y->chunks_s = orl_year_now(y);
    /* Rows have no coefficients; with coefficients, runs share the paths of chunks instead. */
    y->shares_rows = shared && !y->result->coefficients;
    if (code == 0 && shared)
        code = orl_year_run_chunk_tasks(y, compute_chunk, err);
    for (y->first = 0; y->first < n && code == 0; y->first += y->count) {
        y->count = n - y->first < y->chunk_size ? n - y->first : y->chunk_size;
        if (is_restored(y)) {
            y->restored += y->count;
            continue;
        }
        code = run_chunk(y, err);
        if (code == 0)
            report_chunk_done(y);
        orl_year_report_progress(y, ORL_STAGE_RENDER, (double)(y->first + y->count));
    }
    for (uint32_t i = 0; y->healths && i < orl_thread_pool_size(y->env->run->pool); i++)
        orl_health_add(&y->result->health, &y->healths[i]);
    return code;
}

void orl_year_chunks_done(struct orl_year *y)
{
    orl_chunk_rows_done(y);
    free(y->healths);
}
