/* Rows of a block of sensors: paths, the sun straight to them, and both times all hours. */
#include "annual/blocks.h"

#include <stdlib.h>
#include <string.h>

#include "annual/sunlight.h"
#include "annual/trace.h"
#include "scene/geometry/stand.h"

enum orl_year_row {
    ORL_YEAR_TOTAL,
    ORL_YEAR_STRAIGHT,
    ORL_YEAR_SE,
    ORL_YEAR_MIRRORED,
    ORL_YEAR_SQUARES,
    ORL_YEAR_ROWS
};

#define TRACING 0.85 /* of a block's time, more or less */

/* ---- Blocks ---------------------------------------------------------------------------------- */

static float *row_of(const struct orl_year *y, size_t sensor, enum orl_year_row row)
{
    return y->rows + (sensor * ORL_YEAR_ROWS + row) * y->hours.n_columns;
}

static void trace_batch(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const size_t sensor = index / ORL_ANNUAL_BATCHES;
    const struct orl_annual_batch batch = {.seed = y->request->seed,
                                           .sensor = y->first + sensor,
                                           .batch = (uint32_t)(index % ORL_ANNUAL_BATCHES),
                                           .samples = y->batch_samples};
    struct orl_annual_sums sums = {.bins = y->bin_sums + index * ORL_BINS,
                                   .nodes = y->sun_sums + index * y->n_sun,
                                   .beams = y->sun_sums + index * y->n_sun + y->nodes.count,
                                   .lots = y->lot_sums + index * ORL_SUN_MAP_LOTS * y->n_beams};
    memset(sums.bins, 0, ORL_BINS * sizeof *sums.bins);
    memset(sums.nodes, 0, y->n_sun * sizeof *sums.nodes);
    memset(sums.lots, 0, ORL_SUN_MAP_LOTS * y->n_beams * sizeof *sums.lots);
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
    const struct orl_sunlit_hours sun = {row_of(y, index, ORL_YEAR_STRAIGHT),
                                         row_of(y, index, ORL_YEAR_MIRRORED),
                                         row_of(y, index, ORL_YEAR_SQUARES)};
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    orl_sunlit_hours_find(&y->scene, &y->hours, &y->places[index], name, &sun);
    orl_panels_add(&y->panels, &y->places[index], name, sun.mirrored, sun.squares);
}

static void fill_factors(void *arg, size_t index, uint32_t member)
{
    struct orl_year *y = arg;
    const size_t batch = index * ORL_ANNUAL_BATCHES;
    const struct orl_annual_coefficients coefficients = {
        .bins = y->bin_sums + batch * ORL_BINS,
        .sun = y->sun_sums + batch * y->n_sun,
        .lots = y->lot_sums + batch * ORL_SUN_MAP_LOTS * y->n_beams,
        .n_sun = y->n_sun,
        .n_beams = y->n_beams};
    (void)member;
    orl_annual_factors_fill(&y->factors[index], &y->bins, &coefficients,
                            y->sun_by_batch + index * (ORL_ANNUAL_BATCHES + 1) * y->n_sun,
                            y->sun_by_lot + index * ORL_SUN_MAP_LOTS * y->n_beams);
}

static void multiply(void *arg, size_t tile, uint32_t member)
{
    struct orl_year *y = arg;
    (void)member;
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_annual_row row = {row_of(y, i, ORL_YEAR_STRAIGHT),
                                           row_of(y, i, ORL_YEAR_MIRRORED),
                                           row_of(y, i, ORL_YEAR_SQUARES),
                                           row_of(y, i, ORL_YEAR_TOTAL), row_of(y, i, ORL_YEAR_SE)};
        orl_annual_multiply(&y->factors[i], &y->hours, &y->terms, tile, &row);
    }
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
        const float *total = row_of(y, i, ORL_YEAR_TOTAL),
                    *direct = row_of(y, i, ORL_YEAR_STRAIGHT);
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

static int run_block(struct orl_year *y, struct orl_error *err)
{
    struct orl_crew *crew = y->env->run->crew;
    double since = orl_year_now(y);
    place_sensors(y);
    atomic_store(&y->traced, 0);
    int code = orl_crew_try(crew, y->count * ORL_ANNUAL_BATCHES, trace_batch, y);
    orl_year_book(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = orl_crew_try(crew, y->count, find_sun, y);
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    if (code == 0)
        code = orl_crew_try(crew, y->count, fill_factors, y);
    if (code == 0)
        code = orl_crew_try(crew, y->hours.n_tiles, multiply, y);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? orl_year_cancelled(err) : orl_year_no_memory(err);
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
    y->factors = malloc(ORL_YEAR_BLOCK * sizeof *y->factors);
    y->sun_by_batch = malloc(((batches + ORL_YEAR_BLOCK) * y->n_sun + 1) * sizeof *y->sun_by_batch);
    y->healths = calloc(orl_crew_size(y->env->run->crew), sizeof *y->healths);
    if (!y->bin_sums || !y->sun_sums || !y->lot_sums || !y->sun_by_lot || !y->factors ||
        !y->sun_by_batch || !y->rows || !y->healths)
        return ORL_ERR_NOMEM;
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
                                     .se = r->se + at};
}

static bool is_kept(struct orl_year *y)
{
    if (y->env->row || !y->env->kept)
        return false;
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

/* ---- All of them ----------------------------------------------------------------------------- */

int orl_year_run_blocks(struct orl_year *y, struct orl_error *err)
{
    const size_t n = y->request->n_sensors;
    int code = make_room(y) < 0 ? orl_year_no_memory(err) : 0;
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    y->blocks_s = orl_year_now(y);
    for (y->first = 0; y->first < n && code == 0; y->first += y->count) {
        y->count = n - y->first < ORL_YEAR_BLOCK ? n - y->first : ORL_YEAR_BLOCK;
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
    free(y->healths);
}
