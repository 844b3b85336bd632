/* Rows of a block of sensors: paths, direct sunlight, and their products with all hours. */
#include "annual/rows/sensor_blocks.h"

#include <stdlib.h>
#include <string.h>

#include "annual/rows/block_rows.h"
#include "annual/rows/shared_blocks.h"
#include "annual/rows/trace_sensor.h"
#include "annual/sun/sunlight.h"
#include "annual/year/year_inputs.h"
#include "scene/geometry/stand.h"

#define TRACING 0.85 /* approximate share of a block's time */

/* ---- Blocks ---------------------------------------------------------------------------------- */

/* Returns true if the year reports direct sunlight by part and makes no rows. */
static bool reports_sunlight(const struct orl_year *y)
{
    return orl_year_is_sun_only(y) && y->variant->parts;
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
                                           .crew = y->env->run->crew};
    struct orl_annual_sums sums = orl_block_sums_of(&y->sums, sensor, batch.batch);
    orl_annual_trace(&y->scene, &y->places[sensor], &batch, &sums, &y->healths[member]);
    const double whole = (double)(y->count * ORL_ANNUAL_BATCHES);
    const double done = (double)(atomic_fetch_add(&y->traced, 1) + 1);
    if (member == 0) /* the lead thread */
        orl_year_tell(y, ORL_STAGE_RENDER,
                      (double)y->first + TRACING * (double)y->count * done / whole);
}

static void find_sun(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    struct orl_sun_rows rows = orl_block_suns_of(&y->sums, index);
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    rows.direct_only = orl_year_is_sun_only(y);
    rows.disc_points = orl_disc_points(y->request->samples);
    rows.wanted = y->wanted_suns;
    orl_sunlit_hours_find(&y->scene, &y->hours.suns, &y->places[index], name, y->env->run->crew,
                          &rows);
    if (y->has_panels)
        orl_panels_add(&y->panels, &y->places[index], name, y->env->run->crew, &rows);
}

static void place_sensors(struct orl_year *y)
{
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_sensor *sensor = &y->request->sensors[y->first + i];
        const struct orl_vec3 normal = orl_normalize(sensor->direction);
        const struct orl_vec3 at = orl_sub(sensor->position, y->world->geometry->center);
        struct orl_place *place = &y->places[i];
        *place = (struct orl_place){.point = orl_stand(y->world->geometry, at, normal),
                                    .normal = normal};
        place->outside = orl_world_is_outside(y->world, place->point);
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
static void store_packed(struct orl_year *y, struct orl_keeping *it, int code, void *data,
                         size_t size)
{
    if (code == 0)
        orl_keep_put(&y->keep, it, data, size);
    free(data);
}

static uint64_t count_rays(const struct orl_year *y)
{
    uint64_t rays = 0;
    for (uint32_t i = 0; i < orl_crew_size(y->env->run->crew); i++)
        rays += y->healths[i].rays;
    return rays;
}

/* Refuses sensors outdoors if light is split by part, because their light enters through no
 * window. */
static int check_places(const struct orl_year *y, struct orl_error *err)
{
    if (!y->variant || !y->variant->parts)
        return 0;
    for (size_t i = 0; i < y->count; i++)
        if (y->places[i].outside)
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "sensor %zu stands outdoors: its light is not told apart by "
                                 "window groups",
                                 y->first + i + 1);
    return 0;
}

static int trace_paths(struct orl_year *y, struct orl_keeping *it, struct orl_error *err)
{
    const uint64_t before = count_rays(y);
    int code = orl_year_need_scene(y, err);
    if (code < 0)
        return code;
    place_sensors(y);
    code = check_places(y, err);
    if (code < 0)
        return code;
    y->traced_before = it->had / ORL_ANNUAL_BATCHES;
    atomic_store(&y->traced, 0);
    code = orl_crew_try(y->env->run->crew, y->count * ORL_ANNUAL_BATCHES, trace_batch, y);
    it->rays += count_rays(y) - before;
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

static int find_paths(struct orl_year *y, struct orl_error *err)
{
    struct orl_keeping it = {.what = ORL_YEARS_PATHS,
                             .first = y->first,
                             .count = y->count,
                             .samples = y->result->samples};
    void *data = NULL;
    size_t size = 0;
    int code = y->shares_rows ? 0 : orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!orl_block_sums_unpack_paths(&y->sums, y->count, it.data, it.size))
        it.had = 0;
    if (it.had < it.samples)
        code = trace_paths(y, &it, err);
    if (code == 0 && it.owed) {
        const int packed = orl_block_sums_pack_paths(&y->sums, y->count, &data, &size);
        store_packed(y, &it, packed, data, size);
    }
    orl_keep_done(&y->keep, &it);
    return code;
}

static int make_suns(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_need_panels(y, err);
    if (code < 0)
        return code;
    place_sensors(y);
    code = orl_crew_try(y->env->run->crew, y->count, find_sun, y);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

static int find_suns(struct orl_year *y, struct orl_error *err)
{
    struct orl_keeping it = {.what = ORL_YEARS_SUN, .first = y->first, .count = y->count};
    void *data = NULL;
    size_t size = 0;
    int code = y->shares_rows ? 0 : orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!orl_block_sums_unpack_suns(&y->sums, y->count, it.data, it.size))
        code = make_suns(y, err);
    if (code == 0 && it.owed) {
        const int packed = orl_block_sums_pack_suns(&y->sums, y->count, &data, &size);
        store_packed(y, &it, packed, data, size);
    }
    orl_keep_done(&y->keep, &it);
    return code;
}

static void report_sunlight(const struct orl_year *y)
{
    const struct orl_year_parts *parts = y->variant->parts;
    for (size_t i = 0; i < y->count; i++)
        for (uint32_t part = 0; part < y->n_parts; part++)
            if (orl_block_suns_of(&y->sums, i).lit[part]) {
                orl_block_direct(y, i, part, y->rows);
                parts->sunlit(parts->ctx, y->first + i, part, y->rows);
            }
}

/* Computes direct sunlight alone, and reports it by part or as rows. */
static int run_sun_only(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_need_panels(y, err);
    double since = orl_year_now(y);
    if (code < 0)
        return code;
    place_sensors(y);
    code = check_places(y, err);
    orl_block_sums_clear_suns(&y->sums, y->count);
    if (code == 0 && orl_crew_try(y->env->run->crew, y->count, find_sun, y) < 0)
        code = orl_year_cancelled(err);
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    if (code == 0 && reports_sunlight(y))
        report_sunlight(y);
    if (code < 0 || reports_sunlight(y))
        return code;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    for (size_t i = 0; i < y->count; i++)
        orl_block_direct(y, i, 0, orl_year_row_of(y, i, ORL_YEAR_DIRECT));
    return deliver_rows(y, err);
}

/* Computes the rows from paths and suns. */
static int make_rows(struct orl_year *y, struct orl_error *err)
{
    double since = orl_year_now(y);
    int code = find_paths(y, err);
    orl_year_book(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = find_suns(y, err);
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    if (code < 0)
        return code;
    code = orl_block_rows_make(y);
    orl_year_book(y, ORL_ANNUAL_HOURS, &since);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

enum { ROW_ARRAYS = 4 };
struct array {
    void *at;
    size_t bytes;
};

/* Lists the arrays stored for a block: rows, the light of the overcast sky with its error, and
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

static bool load_rows(const struct orl_year *y, const struct orl_keeping *it)
{
    struct array arrays[ROW_ARRAYS];
    const char *from = it->data;
    if (!from || it->size != list_row_arrays(y, arrays))
        return false;
    for (int i = 0; i < ROW_ARRAYS; from += arrays[i++].bytes)
        memcpy(arrays[i].at, from, arrays[i].bytes);
    return true;
}

static void store_rows(struct orl_year *y, struct orl_keeping *it)
{
    struct array arrays[ROW_ARRAYS];
    const size_t size = list_row_arrays(y, arrays);
    char *data = malloc(size + 1), *to = data;
    for (int i = 0; data && i < ROW_ARRAYS; to += arrays[i++].bytes)
        memcpy(to, arrays[i].at, arrays[i].bytes);
    store_packed(y, it, data ? 0 : ORL_ERR_NOMEM, data, size);
}

/* Computes the rows; if runs share the year, takes them from the store where possible. */
static int find_rows(struct orl_year *y, struct orl_error *err)
{
    struct orl_keeping it = {.what = ORL_YEARS_ROWS,
                             .first = y->first,
                             .count = y->count,
                             .samples = y->result->samples};
    if (!y->shares_rows)
        return make_rows(y, err);
    int code = orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!load_rows(y, &it))
        code = make_rows(y, err);
    if (code == 0 && it.owed)
        store_rows(y, &it);
    orl_keep_done(&y->keep, &it);
    return code;
}

static int run_block(struct orl_year *y, struct orl_error *err)
{
    if (orl_year_is_sun_only(y))
        return run_sun_only(y, err);
    int code = find_rows(y, err);
    double since = orl_year_now(y);
    if (code == 0)
        code = deliver_rows(y, err);
    orl_year_book(y, ORL_ANNUAL_HOURS, &since);
    return code;
}

static int make_room(struct orl_year *y)
{
    const size_t columns = y->hours.n_columns, n = y->request->n_sensors;
    struct orl_annual_result *r = y->result;
    y->healths = calloc(orl_crew_size(y->env->run->crew), sizeof *y->healths);
    if (orl_block_rows_init(y) < 0 || !y->healths)
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

/* ---- Stored blocks --------------------------------------------------------------------------- */

/* Returns the current block as a part of the result's arrays, which must exist. */
static struct orl_annual_block block_of(const struct orl_year *y)
{
    const struct orl_annual_result *r = y->result;
    const size_t columns = y->hours.n_columns, at = y->first * columns;
    return (struct orl_annual_block){.round = y->env->round,
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

static bool is_kept(struct orl_year *y)
{
    if (reports_sunlight(y) || y->env->row || !y->env->kept || y->result->coefficients)
        return false; /* coefficients are stored in no block */
    struct orl_annual_block block = block_of(y);
    return y->env->kept(y->env->ctx, &block);
}

static void report_block_done(const struct orl_year *y)
{
    if (reports_sunlight(y) || y->env->row || !y->env->done)
        return;
    const struct orl_annual_block block = block_of(y);
    y->env->done(y->env->ctx, &block);
}

/* Computes the part of a block that distributed runs share: its rows, or its paths and sunlight. */
static int make_block(struct orl_year *y, struct orl_error *err)
{
    if (y->shares_rows)
        return find_rows(y, err);
    const int code = find_paths(y, err);
    return code == 0 ? find_suns(y, err) : code;
}

/* ---- All blocks ------------------------------------------------------------------------------ */

/* Number of sensors per block, such that a tile has at most LIGHTS pairs of a part and a sensor. */
static size_t most_at_a_time(const struct orl_year *y)
{
    enum { LIGHTS = 256, LEAST = 8 };
    const size_t most = LIGHTS / y->n_parts;
    return most < LEAST ? LEAST : most < ORL_YEAR_BLOCK ? most : ORL_YEAR_BLOCK;
}

int orl_year_run_blocks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = y->request->n_sensors, most = most_at_a_time(y);
    const bool shared = y->env->run->pieces && y->keep.store && !orl_year_is_sun_only(y);
    y->block = shared ? orl_year_shared_block(n, most) : most;
    int code = make_room(y) < 0 ? orl_year_no_memory(err) : 0;
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    y->blocks_s = orl_year_now(y);
    /* Rows have no coefficients; with coefficients, runs share the paths of blocks instead. */
    y->shares_rows = shared && !y->result->coefficients;
    if (code == 0 && shared)
        code = orl_year_share_blocks(y, make_block, err);
    for (y->first = 0; y->first < n && code == 0; y->first += y->count) {
        y->count = n - y->first < y->block ? n - y->first : y->block;
        if (is_kept(y)) {
            y->kept += y->count;
            continue;
        }
        code = run_block(y, err);
        if (code == 0)
            report_block_done(y);
        orl_year_tell(y, ORL_STAGE_RENDER, (double)(y->first + y->count));
    }
    for (uint32_t i = 0; y->healths && i < orl_crew_size(y->env->run->crew); i++)
        orl_health_add(&y->result->health, &y->healths[i]);
    return code;
}

void orl_year_blocks_done(struct orl_year *y)
{
    orl_block_rows_done(y);
    free(y->healths);
}
