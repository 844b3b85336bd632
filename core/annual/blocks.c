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
#define TRACING 0.85 /* of a block's time, more or less */

/* ---- Blocks ---------------------------------------------------------------------------------- */

/* Whether direct sunlight is told by part, and no row is made. */
static bool tells_sunlight(const struct orl_year *y)
{
    return orl_year_is_sun_only(y) && y->variant->parts;
}

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
                                           .first = y->traced_before,
                                           .samples = y->batch_samples,
                                           .crew = y->env->run->crew};
    struct orl_annual_sums sums = orl_block_sums_of(&y->sums, sensor, batch.batch);
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
    struct orl_sun_rows rows = orl_block_suns_of(&y->sums, index);
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    rows.direct_only = orl_year_is_sun_only(y);
    rows.wanted = y->wanted_suns;
    orl_sunlit_hours_find(&y->scene, &y->hours.suns, &y->places[index], name, y->env->run->crew,
                          &rows);
    if (y->has_panels)
        orl_panels_add(&y->panels, &y->places[index], name, &rows);
}

/* Sums of a sensor's batches for a part; returns false if there are none. */
static bool coefficients_of(const struct orl_year *y, size_t sensor, uint32_t part,
                            struct orl_annual_coefficients *ret)
{
    bool any = false;
    *ret =
        (struct orl_annual_coefficients){.samples = y->batch_samples, .n_nodes = y->sums.n_nodes};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_annual_sums sums = orl_block_sums_of(&y->sums, sensor, b);
        if (!sums.lit[part])
            continue;
        ret->bins[b] = sums.bins + (size_t)part * ORL_BINS;
        ret->nodes[b] = sums.nodes + part * sums.n_nodes;
        any = true;
    }
    return any;
}

static void fill_beams(struct orl_year *y, size_t sensor)
{
    const size_t n = y->n_beams;
    struct orl_annual_beam_coefficients coefficients = {.samples = y->batch_samples, .n_beams = n};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_annual_sums sums = orl_block_sums_of(&y->sums, sensor, b);
        coefficients.beams[b] = sums.beams;
        coefficients.lots[b] = sums.lots;
    }
    orl_annual_beams_fill(&y->beams[sensor], &coefficients,
                          y->beam_factors + sensor * (ORL_ANNUAL_BATCHES + 1) * n,
                          y->lot_factors + sensor * ORL_SUN_MAP_LOTS * n);
}

static bool is_lit_by_beams(const struct orl_year *y, size_t sensor, uint32_t part)
{
    for (size_t i = 0; i < y->n_beams; i++)
        if (y->part_of_beam[i] == part && y->beams[sensor].means[i] > 0)
            return true;
    return false;
}

static void fill_factors(void *arg, size_t sensor, uint32_t member)
{
    struct orl_year *y = arg;
    double overcast[ORL_ANNUAL_BATCHES] = {0};
    (void)member;
    fill_beams(y, sensor);
    for (uint32_t part = 0; part < y->n_parts; part++) {
        const size_t at = sensor * y->n_parts + part;
        struct orl_annual_coefficients coefficients;
        y->lit[at] =
            coefficients_of(y, sensor, part, &coefficients) || is_lit_by_beams(y, sensor, part);
        if (!y->lit[at])
            continue;
        orl_overcast_add(&y->overcast, &coefficients, overcast);
        orl_annual_factors_fill(&y->factors[at], &y->bins, &coefficients,
                                y->factor_nodes +
                                    at * (ORL_ANNUAL_BATCHES + 1) * coefficients.n_nodes);
        if (y->result->coefficients)
            orl_annual_factors_tell(&y->factors[at], y->result->coefficients +
                                                         (y->first + sensor) * ORL_ANNUAL_PATCHES);
    }
    orl_overcast_find(overcast, &y->result->overcast[y->first + sensor],
                      &y->result->overcast_se[y->first + sensor]);
}

/* The light of a part at a sensor; returns false if there is none. */
static bool light_of(const struct orl_year *y, size_t sensor, uint32_t part,
                     const struct orl_annual_row *row, struct orl_annual_share *ret)
{
    const struct orl_sun_rows suns = orl_block_suns_of(&y->sums, sensor);
    const struct orl_year_parts *parts = y->variant ? y->variant->parts : NULL;
    const size_t at = sensor * y->n_parts + part;
    *ret = (struct orl_annual_share){
        .row = row,
        .part = part,
        .factors = y->lit[at] ? &y->factors[at] : NULL,
        .beams = &y->beams[sensor],
        .wanted = parts && parts->wanted ? parts->wanted + part * y->hours.n_columns : NULL};
    if (suns.lit[part]) {
        ret->by_sun = orl_sun_row_of(&suns, part, ORL_SUN_DIRECT);
        ret->mirrored = orl_sun_row_of(&suns, part, ORL_SUN_MIRRORED);
        ret->squares = orl_sun_row_of(&suns, part, ORL_SUN_SQUARES);
    }
    return ret->factors || ret->by_sun;
}

static void multiply(void *arg, size_t tile, uint32_t member)
{
    const struct orl_year *y = arg;
    struct orl_annual_share lights[ORL_ANNUAL_MOST_SHARES];
    struct orl_annual_row rows[ORL_YEAR_BLOCK];
    size_t n = 0;
    (void)member;
    for (size_t i = 0; i < y->count; i++) {
        rows[i] = (struct orl_annual_row){row_of(y, i, ORL_YEAR_TOTAL),
                                          row_of(y, i, ORL_YEAR_DIRECT), row_of(y, i, ORL_YEAR_SE)};
        for (uint32_t part = 0; part < y->n_parts; part++)
            n += light_of(y, i, part, &rows[i], &lights[n]);
    }
    orl_annual_multiply(lights, n, &y->hours, &y->terms, tile);
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

/* ---- Sums and rows, kept or made ------------------------------------------------------------- */

/* Keeps what was packed, unless there was no memory for it. */
static void keep_packed(struct orl_year *y, struct orl_keeping *it, int code, void *data,
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

/* Outdoors light comes by no window. */
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
        code = trace(y, &it, err);
    if (code == 0 && it.owed) {
        const int packed = orl_block_sums_pack_paths(&y->sums, y->count, &data, &size);
        keep_packed(y, &it, packed, data, size);
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
        keep_packed(y, &it, packed, data, size);
    }
    orl_keep_done(&y->keep, &it);
    return code;
}

/* Direct sunlight of a part at a sensor, by column. */
static void find_direct(const struct orl_year *y, size_t sensor, uint32_t part, float *ret_lx)
{
    const struct orl_sun_rows suns = orl_block_suns_of(&y->sums, sensor);
    const float *by_sun = orl_sun_row_of(&suns, part, ORL_SUN_DIRECT);
    for (size_t c = 0; c < y->hours.n_columns; c++) {
        const struct orl_column_sun *sun = &y->hours.sun_of_column[c];
        ret_lx[c] = suns.lit[part] && sun->normal_lx > 0
                        ? (float)(sun->normal_lx * (double)by_sun[sun->sun])
                        : 0;
    }
}

static void tell_sunlight(const struct orl_year *y)
{
    const struct orl_year_parts *parts = y->variant->parts;
    for (size_t i = 0; i < y->count; i++)
        for (uint32_t part = 0; part < y->n_parts; part++)
            if (orl_block_suns_of(&y->sums, i).lit[part]) {
                find_direct(y, i, part, y->rows);
                parts->sunlit(parts->ctx, y->first + i, part, y->rows);
            }
}

/* Direct sunlight is all there is. */
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
    if (code == 0 && tells_sunlight(y))
        tell_sunlight(y);
    if (code < 0 || tells_sunlight(y))
        return code;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    for (size_t i = 0; i < y->count; i++)
        find_direct(y, i, 0, row_of(y, i, ORL_YEAR_DIRECT));
    return hand_over(y, err);
}

/* Paths and suns times all hours. */
static int make_rows(struct orl_year *y, struct orl_error *err)
{
    struct orl_crew *crew = y->env->run->crew;
    double since = orl_year_now(y);
    int code = find_paths(y, err);
    orl_year_book(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = find_suns(y, err);
    orl_year_book(y, ORL_ANNUAL_SUN, &since);
    if (code < 0)
        return code;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    code = orl_crew_try(crew, y->count, fill_factors, y);
    if (code == 0)
        code = orl_crew_try(crew, y->hours.n_tiles, multiply, y);
    orl_year_book(y, ORL_ANNUAL_HOURS, &since);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

enum { ROW_ARRAYS = 3 };
struct array {
    void *at;
    size_t bytes;
};

/* Rows, and the overcast sky's light with its error. */
static size_t list_row_arrays(const struct orl_year *y, struct array ret[ROW_ARRAYS])
{
    const struct orl_annual_result *r = y->result;
    ret[0] =
        (struct array){y->rows, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows};
    ret[1] = (struct array){r->overcast + y->first, y->count * sizeof *r->overcast};
    ret[2] = (struct array){r->overcast_se + y->first, y->count * sizeof *r->overcast_se};
    return ret[0].bytes + ret[1].bytes + ret[2].bytes;
}

static bool take_rows(const struct orl_year *y, const struct orl_keeping *it)
{
    struct array arrays[ROW_ARRAYS];
    const char *from = it->data;
    if (!from || it->size != list_row_arrays(y, arrays))
        return false;
    for (int i = 0; i < ROW_ARRAYS; from += arrays[i++].bytes)
        memcpy(arrays[i].at, from, arrays[i].bytes);
    return true;
}

static void keep_rows(struct orl_year *y, struct orl_keeping *it)
{
    struct array arrays[ROW_ARRAYS];
    const size_t size = list_row_arrays(y, arrays);
    char *data = malloc(size + 1), *to = data;
    for (int i = 0; data && i < ROW_ARRAYS; to += arrays[i++].bytes)
        memcpy(to, arrays[i].at, arrays[i].bytes);
    keep_packed(y, it, data ? 0 : ORL_ERR_NOMEM, data, size);
}

/* Made, or by who shares the year. */
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
    if (!take_rows(y, &it))
        code = make_rows(y, err);
    if (code == 0 && it.owed)
        keep_rows(y, &it);
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

/* Of suns that nobody has a use for, BSDF panes send no light. All are of use to who keeps them. */
static int want_suns(struct orl_year *y)
{
    const struct orl_year_parts *parts = y->variant ? y->variant->parts : NULL;
    const size_t suns = y->hours.suns.count;
    if (!parts || !parts->wanted || !parts->direct_as_wanted || y->keep.store)
        return 0;
    y->wanted_suns = calloc(y->n_parts * suns + 1, sizeof *y->wanted_suns);
    if (!y->wanted_suns)
        return ORL_ERR_NOMEM;
    for (uint32_t part = 0; part < y->n_parts; part++)
        for (size_t c = 0; c < y->hours.n_columns; c++)
            if (y->hours.sun_of_column[c].normal_lx > 0 &&
                parts->wanted[part * y->hours.n_columns + c])
                y->wanted_suns[part * suns + y->hours.sun_of_column[c].sun] = 1;
    return 0;
}

static int find_parts_of_beams(struct orl_year *y)
{
    y->part_of_beam = calloc(y->n_beams + 1, sizeof *y->part_of_beam);
    for (size_t sun = 0; y->part_of_beam && y->n_beams > 0 && sun < y->hours.suns.count; sun++)
        for (uint32_t part = 0; part < y->n_parts; part++) {
            const struct orl_sun_range range = orl_sun_terms_beams(&y->terms, sun, part);
            for (uint32_t i = range.first; i < range.end; i++)
                y->part_of_beam[y->terms.which[i]] = (uint16_t)part;
        }
    return y->part_of_beam ? 0 : ORL_ERR_NOMEM;
}

/* For so many sensors at a time. */
static int make_sums(struct orl_year *y, size_t n)
{
    const size_t lights = n * y->n_parts;
    const bool sun_only = orl_year_is_sun_only(y);
    y->sums = (struct orl_block_sums){.n_sensors = n,
                                      .n_parts = y->n_parts,
                                      .n_nodes = sun_only ? 0 : y->nodes.count,
                                      .n_beams = y->n_beams,
                                      .n_suns = y->hours.suns.count};
    if (orl_block_sums_init(&y->sums) < 0 || want_suns(y) < 0 || find_parts_of_beams(y) < 0)
        return ORL_ERR_NOMEM;
    y->lit = calloc(lights + 1, sizeof *y->lit);
    y->factors = malloc((lights + 1) * sizeof *y->factors);
    y->factor_nodes =
        malloc((lights * (ORL_ANNUAL_BATCHES + 1) * y->sums.n_nodes + 1) * sizeof *y->factor_nodes);
    y->beams = calloc(n + 1, sizeof *y->beams);
    y->beam_factors =
        malloc((n * (ORL_ANNUAL_BATCHES + 1) * y->n_beams + 1) * sizeof *y->beam_factors);
    y->lot_factors = malloc((n * ORL_SUN_MAP_LOTS * y->n_beams + 1) * sizeof *y->lot_factors);
    return y->lit && y->factors && y->factor_nodes && y->beams && y->beam_factors && y->lot_factors
               ? 0
               : ORL_ERR_NOMEM;
}

static int make_room(struct orl_year *y)
{
    const size_t columns = y->hours.n_columns, n = y->request->n_sensors;
    struct orl_annual_result *r = y->result;
    y->rows = malloc((y->block * ORL_YEAR_ROWS * columns + 1) * sizeof *y->rows);
    y->healths = calloc(orl_crew_size(y->env->run->crew), sizeof *y->healths);
    if (make_sums(y, y->block) < 0 || !y->rows || !y->healths)
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
    if (y->env->row || tells_sunlight(y))
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
    if (tells_sunlight(y) || y->env->row || !y->env->kept || y->result->coefficients)
        return false; /* coefficients are in no block */
    struct orl_annual_block block = block_of(y);
    return y->env->kept(y->env->ctx, &block);
}

static void tell_done(const struct orl_year *y)
{
    if (tells_sunlight(y) || y->env->row || !y->env->done)
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

/* Sensors at a time: as many lights, of a part at a sensor each, as a tile takes. */
static size_t most_at_a_time(const struct orl_year *y)
{
    enum { LIGHTS = ORL_ANNUAL_MOST_SHARES / 2, LEAST = 8 };
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
    /* Coefficients are in no row: then blocks are shared by their paths. */
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
            tell_done(y);
        orl_year_tell(y, ORL_STAGE_RENDER, (double)(y->first + y->count));
    }
    for (uint32_t i = 0; y->healths && i < orl_crew_size(y->env->run->crew); i++)
        orl_health_add(&y->result->health, &y->healths[i]);
    return code;
}

void orl_year_blocks_done(struct orl_year *y)
{
    orl_block_sums_done(&y->sums);
    free(y->wanted_suns);
    free(y->part_of_beam);
    free(y->lit);
    free(y->factors);
    free(y->factor_nodes);
    free(y->beams);
    free(y->beam_factors);
    free(y->lot_factors);
    free(y->rows);
    free(y->healths);
}
