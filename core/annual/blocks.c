/* Rows of a block of sensors: paths, the sun straight to them, and both times all hours. */
#include "annual/blocks.h"

#include <stdlib.h>
#include <string.h>

#include "annual/light.h"
#include "annual/shared_blocks.h"
#include "annual/sunlight.h"
#include "annual/trace.h"
#include "scene/geometry/stand.h"

enum orl_year_row { ORL_YEAR_TOTAL, ORL_YEAR_DIRECT, ORL_YEAR_SE, ORL_YEAR_ROWS };
/* By sun: direct sunlight (oriel/annual.h), what mirrors send, squares of both's standard error. */
enum orl_sun_row { ORL_SUN_DIRECT, ORL_SUN_MIRRORED, ORL_SUN_SQUARES, ORL_SUN_ROWS };

#define TRACING 0.85 /* of a block's time, more or less */

/* ---- Blocks ---------------------------------------------------------------------------------- */

static float *row_of(const struct orl_year *y, size_t sensor, enum orl_year_row row)
{
    return y->rows + (sensor * ORL_YEAR_ROWS + row) * y->hours.n_columns;
}

static float *sun_row_of(const struct orl_year *y, size_t sensor, enum orl_sun_row row)
{
    return y->sun_rows + (sensor * ORL_SUN_ROWS + row) * y->hours.suns.count;
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
    if (y->dark[sensor])
        return;
    struct orl_annual_sums sums = {.bins = y->bin_sums + index * ORL_BINS,
                                   .nodes = y->sun_sums + index * y->n_sun,
                                   .beams = y->sun_sums + index * y->n_sun + y->nodes.count,
                                   .lots = y->lot_sums + index * ORL_SUN_MAP_LOTS * y->n_beams};
    orl_annual_trace(&y->scene, &y->places[sensor], &batch, &sums, &y->healths[member]);
    const double whole = (double)(y->count * ORL_ANNUAL_BATCHES);
    const double done = (double)(atomic_fetch_add(&y->traced, 1) + 1);
    if (member == 0) /* the lead */
        orl_year_tell(y, ORL_STAGE_RENDER,
                      (double)y->first + TRACING * (double)y->count * done / whole);
}

static void find_sun(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const struct orl_sunlit_hours sun = {
        sun_row_of(y, index, ORL_SUN_DIRECT),
        orl_year_is_sun_only(y) ? NULL : sun_row_of(y, index, ORL_SUN_MIRRORED),
        sun_row_of(y, index, ORL_SUN_SQUARES)};
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    if (y->dark[index]) {
        for (int row = 0; row < ORL_SUN_ROWS; row++)
            memset(sun_row_of(y, index, (enum orl_sun_row)row), 0,
                   y->hours.suns.count * sizeof *y->sun_rows);
        return;
    }
    orl_sunlit_hours_find(&y->scene, &y->hours.suns, &y->places[index], name, y->env->run->crew,
                          &sun);
    if (y->has_panels)
        orl_panels_add(&y->panels, &y->places[index], name, sun.straight, sun.squares);
}

static void fill_factors(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const size_t batch = index * ORL_ANNUAL_BATCHES;
    const struct orl_annual_coefficients coefficients = {
        .samples = y->batch_samples,
        .bins = y->bin_sums + batch * ORL_BINS,
        .sun = y->sun_sums + batch * y->n_sun,
        .lots = y->lot_sums + batch * ORL_SUN_MAP_LOTS * y->n_beams,
        .n_sun = y->n_sun,
        .n_beams = y->n_beams};
    (void)member;
    if (y->dark[index])
        return;
    orl_overcast_find(&y->overcast, &coefficients, &y->result->overcast[y->first + index],
                      &y->result->overcast_se[y->first + index]);
    orl_annual_factors_fill(&y->factors[index], &y->bins, &coefficients,
                            y->sun_by_batch + index * (ORL_ANNUAL_BATCHES + 1) * y->n_sun,
                            y->sun_by_lot + index * ORL_SUN_MAP_LOTS * y->n_beams);
    if (y->result->coefficients)
        orl_annual_factors_tell(&y->factors[index],
                                y->result->coefficients + (y->first + index) * ORL_ANNUAL_PATCHES);
}

static void multiply(void *arg, size_t tile, uint32_t member)
{
    struct orl_year *y = arg;
    struct orl_annual_row rows[ORL_YEAR_BLOCK];
    (void)member;
    const struct orl_annual_factors *factors[ORL_YEAR_BLOCK];
    size_t lit = 0;
    for (size_t i = 0; i < y->count; i++) {
        if (y->dark[i])
            continue;
        factors[lit] = &y->factors[i];
        rows[lit++] = (struct orl_annual_row){
            sun_row_of(y, i, ORL_SUN_DIRECT),  sun_row_of(y, i, ORL_SUN_MIRRORED),
            sun_row_of(y, i, ORL_SUN_SQUARES), row_of(y, i, ORL_YEAR_TOTAL),
            row_of(y, i, ORL_YEAR_DIRECT),     row_of(y, i, ORL_YEAR_SE)};
    }
    orl_annual_multiply(factors, lit, &y->hours, &y->terms, tile, rows);
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

static int hand_over(struct orl_year *y, struct orl_error *err)
{
    const size_t columns = y->hours.n_columns, bytes = columns * sizeof(float);
    for (size_t i = 0; i < y->count; i++) {
        const size_t sensor = y->first + i;
        const float *total = row_of(y, i, ORL_YEAR_TOTAL), *direct = row_of(y, i, ORL_YEAR_DIRECT);
        const float *se = row_of(y, i, ORL_YEAR_SE);
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

/* ---- Parts of a block, kept or made ---------------------------------------------------------- */

/* The arrays of a part, one behind the other. */
struct part {
    void *at;
    size_t bytes;
};

enum { MOST_PARTS = 3 };

static size_t bytes_of(const struct part parts[MOST_PARTS])
{
    size_t bytes = 0;
    for (int i = 0; i < MOST_PARTS; i++)
        bytes += parts[i].bytes;
    return bytes;
}

/* From what was kept; true where there is any. */
static bool fill_parts(const struct orl_keeping *it, const struct part parts[MOST_PARTS])
{
    const char *from = it->data;
    if (from && it->size != bytes_of(parts))
        from = NULL;
    for (int i = 0; i < MOST_PARTS && parts[i].at; i++) {
        if (!from) {
            memset(parts[i].at, 0, parts[i].bytes);
            continue;
        }
        memcpy(parts[i].at, from, parts[i].bytes);
        from += parts[i].bytes;
    }
    return from != NULL;
}

static void put_parts(struct orl_year *y, struct orl_keeping *it,
                      const struct part parts[MOST_PARTS])
{
    char *data = it->owed ? malloc(bytes_of(parts) + 1) : NULL, *to = data;
    for (int i = 0; data && i < MOST_PARTS && parts[i].at; i++) {
        memcpy(to, parts[i].at, parts[i].bytes);
        to += parts[i].bytes;
    }
    if (data)
        orl_keep_put(&y->keep, it, data, bytes_of(parts));
    free(data);
}

static uint64_t count_rays(const struct orl_year *y)
{
    uint64_t rays = 0;
    for (uint32_t i = 0; i < orl_crew_size(y->env->run->crew); i++)
        rays += y->healths[i].rays;
    return rays;
}

/* Outdoors light comes by no window. */
static int check_places(const struct orl_year *y, struct orl_error *err)
{
    if (!y->variant || y->variant->part == 0)
        return 0;
    for (size_t i = 0; i < y->count; i++)
        if (y->places[i].outside)
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "sensor %zu stands outdoors: its light is not told apart by "
                                 "window groups",
                                 y->first + i + 1);
    return 0;
}

static int trace(struct orl_year *y, struct orl_keeping *it, struct orl_error *err)
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
    const size_t batches = y->count * ORL_ANNUAL_BATCHES;
    const struct part parts[MOST_PARTS] = {
        {y->sun_sums, batches * y->n_sun * sizeof *y->sun_sums},
        {y->bin_sums, batches * ORL_BINS * sizeof *y->bin_sums},
        {y->lot_sums, batches * ORL_SUN_MAP_LOTS * y->n_beams * sizeof *y->lot_sums}};
    struct orl_keeping it = {.what = ORL_YEARS_PATHS,
                             .first = y->first,
                             .count = y->count,
                             .samples = y->result->samples};
    int code = y->shares_rows ? 0 : orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!fill_parts(&it, parts))
        it.had = 0;
    if (it.had < it.samples)
        code = trace(y, &it, err);
    if (code == 0)
        put_parts(y, &it, parts);
    orl_keep_done(&y->keep, &it);
    return code;
}

static int find_suns(struct orl_year *y, struct orl_error *err)
{
    const size_t bytes = y->count * ORL_SUN_ROWS * y->hours.suns.count * sizeof *y->sun_rows;
    const struct part parts[MOST_PARTS] = {{y->sun_rows, bytes}};
    struct orl_keeping it = {.what = ORL_YEARS_SUN, .first = y->first, .count = y->count};
    int code = y->shares_rows ? 0 : orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!fill_parts(&it, parts)) {
        code = orl_year_need_panels(y, err);
        if (code == 0) {
            place_sensors(y);
            code = orl_crew_try(y->env->run->crew, y->count, find_sun, y);
            code = code < 0 ? orl_year_failed(y, code, err) : 0;
        }
    }
    if (code == 0)
        put_parts(y, &it, parts);
    orl_keep_done(&y->keep, &it);
    return code;
}

static void find_darkness(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    (void)member;
    y->dark[index] = !orl_reach_has(&y->reach, &y->places[index]);
}

/* Marks the sensors that light of a part cannot reach; their rows are zero. */
static int find_dark(struct orl_year *y, size_t *ret_lit, struct orl_error *err)
{
    *ret_lit = y->count;
    if (!y->variant || y->variant->part == 0)
        return 0;
    int code = orl_year_need_scene(y, err);
    if (code < 0)
        return code;
    place_sensors(y);
    code = check_places(y, err);
    if (code == 0 && orl_crew_try(y->env->run->crew, y->count, find_darkness, y) < 0)
        code = orl_year_cancelled(err);
    for (size_t i = 0; i < y->count && code == 0; i++) {
        if (!y->dark[i])
            continue;
        --*ret_lit;
        memset(row_of(y, i, ORL_YEAR_TOTAL), 0,
               ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    }
    return code;
}

/* Direct sunlight is all there is. */
static int run_sun_only(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_need_panels(y, err);
    double since = orl_year_now(y);
    size_t lit = 0;
    if (code < 0)
        return code;
    place_sensors(y);
    code = find_dark(y, &lit, err);
    if (code == 0 && orl_crew_try(y->env->run->crew, y->count, find_sun, y) < 0)
        code = orl_year_cancelled(err);
    for (size_t i = 0; i < y->count && code == 0; i++) {
        const float *by_sun = sun_row_of(y, i, ORL_SUN_DIRECT);
        float *direct = row_of(y, i, ORL_YEAR_DIRECT);
        memset(row_of(y, i, ORL_YEAR_TOTAL), 0, y->hours.n_columns * sizeof(float));
        memset(row_of(y, i, ORL_YEAR_SE), 0, y->hours.n_columns * sizeof(float));
        for (size_t c = 0; c < y->hours.n_columns; c++) {
            const struct orl_column_sun *sun = &y->hours.sun_of_column[c];
            direct[c] = sun->normal_lx > 0 ? (float)(sun->normal_lx * (double)by_sun[sun->sun]) : 0;
        }
    }
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    return code == 0 ? hand_over(y, err) : code;
}

/* Paths and suns times all hours. */
static int make_rows(struct orl_year *y, struct orl_error *err)
{
    struct orl_crew *crew = y->env->run->crew;
    size_t lit = 0;
    const int found = find_dark(y, &lit, err);
    if (found < 0 || lit == 0)
        return found;
    double since = orl_year_now(y);
    int code = find_paths(y, err);
    orl_year_book(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = find_suns(y, err);
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    if (code < 0)
        return code;
    code = orl_crew_try(crew, y->count, fill_factors, y);
    if (code == 0)
        code = orl_crew_try(crew, y->hours.n_tiles, multiply, y);
    orl_year_book(y, ORL_ANNUAL_HOURS, &since);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

/* Made, or by who shares the year. */
static int find_rows(struct orl_year *y, struct orl_error *err)
{
    const struct part parts[MOST_PARTS] = {
        {y->rows, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows},
        {y->result->overcast + y->first, y->count * sizeof *y->result->overcast},
        {y->result->overcast_se + y->first, y->count * sizeof *y->result->overcast_se}};
    struct orl_keeping it = {.what = ORL_YEARS_ROWS,
                             .first = y->first,
                             .count = y->count,
                             .samples = y->result->samples};
    if (!y->shares_rows)
        return make_rows(y, err);
    int code = orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (!fill_parts(&it, parts))
        code = make_rows(y, err);
    if (code == 0)
        put_parts(y, &it, parts);
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
        code = hand_over(y, err);
    orl_year_book(y, ORL_ANNUAL_HOURS, &since);
    return code;
}

static int make_room(struct orl_year *y)
{
    const size_t columns = y->hours.n_columns, n = y->request->n_sensors;
    const size_t batches = (n < ORL_YEAR_BLOCK ? n : ORL_YEAR_BLOCK) * ORL_ANNUAL_BATCHES;
    struct orl_annual_result *r = y->result;
    y->bin_sums = malloc(batches * ORL_BINS * sizeof *y->bin_sums);
    y->sun_sums = malloc((batches * y->n_sun + 1) * sizeof *y->sun_sums);
    y->lot_sums = malloc((batches * ORL_SUN_MAP_LOTS * y->n_beams + 1) * sizeof *y->lot_sums);
    y->sun_by_lot = malloc(((size_t)ORL_YEAR_BLOCK * ORL_SUN_MAP_LOTS * y->n_beams + 1) *
                           sizeof *y->sun_by_lot);
    y->rows = malloc(((size_t)ORL_YEAR_BLOCK * ORL_YEAR_ROWS * columns + 1) * sizeof *y->rows);
    y->sun_rows = malloc(((size_t)ORL_YEAR_BLOCK * ORL_SUN_ROWS * y->hours.suns.count + 1) *
                         sizeof *y->sun_rows);
    y->factors = malloc(ORL_YEAR_BLOCK * sizeof *y->factors);
    y->sun_by_batch = malloc(((batches + ORL_YEAR_BLOCK) * y->n_sun + 1) * sizeof *y->sun_by_batch);
    y->healths = calloc(orl_crew_size(y->env->run->crew), sizeof *y->healths);
    if (!y->bin_sums || !y->sun_sums || !y->lot_sums || !y->sun_by_lot || !y->factors ||
        !y->sun_by_batch || !y->rows || !y->sun_rows || !y->healths)
        return ORL_ERR_NOMEM;
    orl_overcast_init(&y->overcast, &y->bins, y->request->ground_reflectance);
    r->overcast = calloc(n + 1, sizeof *r->overcast);
    r->overcast_se = calloc(n + 1, sizeof *r->overcast_se);
    if (!r->overcast || !r->overcast_se)
        return ORL_ERR_NOMEM;
    if (y->request->coefficients) {
        r->coefficients = calloc(n * ORL_ANNUAL_PATCHES + 1, sizeof *r->coefficients);
        if (!r->coefficients)
            return ORL_ERR_NOMEM;
    }
    if (y->env->row)
        return 0;
    r->total = malloc((n * columns + 1) * sizeof *r->total);
    r->direct = malloc((n * columns + 1) * sizeof *r->direct);
    r->se = malloc((n * columns + 1) * sizeof *r->se);
    return r->total && r->direct && r->se ? 0 : ORL_ERR_NOMEM;
}

/* ---- Blocks that are kept -------------------------------------------------------------------- */

/* Where arrays are kept, the block's part of them. */
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
                                     .overcast_se = r->overcast_se + y->first};
}

static bool is_kept(struct orl_year *y)
{
    if (y->env->row || !y->env->kept || y->result->coefficients)
        return false; /* coefficients are in no block */
    struct orl_annual_block block = block_of(y);
    return y->env->kept(y->env->ctx, &block);
}

static void tell_done(const struct orl_year *y)
{
    if (y->env->row || !y->env->done)
        return;
    const struct orl_annual_block block = block_of(y);
    y->env->done(y->env->ctx, &block);
}

/* What of a block others can make. */
static int make_block(struct orl_year *y, struct orl_error *err)
{
    if (y->shares_rows)
        return find_rows(y, err);
    const int code = find_paths(y, err);
    return code == 0 ? find_suns(y, err) : code;
}

/* ---- All of them ----------------------------------------------------------------------------- */

int orl_year_run_blocks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = y->request->n_sensors;
    int code = make_room(y) < 0 ? orl_year_no_memory(err) : 0;
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    y->blocks_s = orl_year_now(y);
    const bool shared = y->env->run->pieces && y->keep.store && !orl_year_is_sun_only(y);
    /* Coefficients are in no row: then blocks are shared by their paths. */
    y->shares_rows = shared && !y->result->coefficients;
    y->block = shared ? orl_year_shared_block(n) : ORL_YEAR_BLOCK;
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
            tell_done(y);
        orl_year_tell(y, ORL_STAGE_RENDER, (double)(y->first + y->count));
    }
    for (uint32_t i = 0; y->healths && i < orl_crew_size(y->env->run->crew); i++)
        orl_health_add(&y->result->health, &y->healths[i]);
    return code;
}

void orl_year_blocks_done(struct orl_year *y)
{
    free(y->bin_sums);
    free(y->sun_sums);
    free(y->factors);
    free(y->sun_by_batch);
    free(y->lot_sums);
    free(y->sun_by_lot);
    free(y->rows);
    free(y->sun_rows);
    free(y->healths);
}
