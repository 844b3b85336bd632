#include "annual/rows/block_rows.h"

#include <stdlib.h>
#include <string.h>

/* ---- Coefficients ---------------------------------------------------------------------------- */

/* Collects the sums of a sensor's batches for a part; returns false if there are none. */
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

/* Marks the parts of beams that reach a sensor. */
static void mark_beams(const struct orl_year *y, size_t sensor, bool *lit)
{
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const double *beams = orl_block_sums_of(&y->sums, sensor, b).beams;
        for (size_t i = 0; i < y->n_beams; i++)
            if (beams[i] > 0)
                lit[y->part_of_beam[i]] = true;
    }
}

/* Fills the sensor's beams of lit parts. */
static void fill_beams(struct orl_year *y, size_t sensor, const bool *lit)
{
    const size_t n = y->n_beams;
    uint32_t *which = y->beam_lists + sensor * n;
    struct orl_annual_beam_coefficients coefficients = {
        .samples = y->batch_samples, .which = which, .n_beams = n};
    for (uint32_t i = 0; i < n; i++)
        if (lit[y->part_of_beam[i]])
            which[coefficients.n_which++] = i;
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_annual_sums sums = orl_block_sums_of(&y->sums, sensor, b);
        coefficients.beams[b] = sums.beams;
        coefficients.lots[b] = sums.lots;
    }
    orl_annual_beams_fill(&y->beams[sensor], &coefficients,
                          y->beam_factors + sensor * (ORL_ANNUAL_BATCHES + 1) * n,
                          y->lot_factors + sensor * ORL_SUN_MAP_LOTS * n);
}

static void fill_factors(void *arg, size_t sensor, uint32_t member)
{
    struct orl_year *y = arg;
    bool *lit = y->lit + sensor * y->n_parts;
    double overcast[ORL_ANNUAL_BATCHES] = {0};
    (void)member;
    memset(lit, 0, y->n_parts * sizeof *lit);
    mark_beams(y, sensor, lit);
    for (uint32_t part = 0; part < y->n_parts; part++) {
        const size_t at = sensor * y->n_parts + part;
        struct orl_annual_coefficients coefficients;
        lit[part] = coefficients_of(y, sensor, part, &coefficients) || lit[part];
        if (!lit[part])
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
    fill_beams(y, sensor, lit);
}

/* Collects the light of a part at a sensor; returns false if there is none. */
static bool light_of(const struct orl_year *y, size_t sensor, uint32_t part,
                     struct orl_annual_share *ret)
{
    const struct orl_sun_rows suns = orl_block_suns_of(&y->sums, sensor);
    const struct orl_year_parts *parts = y->variant ? y->variant->parts : NULL;
    const size_t at = sensor * y->n_parts + part;
    *ret = (struct orl_annual_share){
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

/* ---- Rows ------------------------------------------------------------------------------------ */

static void multiply_tile(void *arg, size_t tile, uint32_t member)
{
    const struct orl_year *y = arg;
    (void)member;
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_annual_row row = {
            orl_year_row_of(y, i, ORL_YEAR_TOTAL), orl_year_row_of(y, i, ORL_YEAR_DIRECT),
            orl_year_row_of(y, i, ORL_YEAR_SE), y->between + i * y->hours.n_columns,
            &y->error_sums[(tile * y->count + i) * ORL_ERROR_BANDS]};
        struct orl_annual_share lights[ORL_SHADES_MOST_GROUPS + 1];
        size_t n = 0;
        for (uint32_t part = 0; part < y->n_parts; part++)
            n += light_of(y, i, part, &lights[n]);
        orl_annual_multiply(&row, lights, n, &y->hours, &y->terms, tile);
    }
}

static void find_coherence(void *arg, size_t sensor, uint32_t member)
{
    const struct orl_year *y = arg;
    (void)member;
    y->result->coherence[y->first + sensor] =
        orl_coherence_of(y->error_sums + sensor * ORL_ERROR_BANDS, y->hours.n_tiles, y->count,
                         orl_year_row_of(y, sensor, ORL_YEAR_TOTAL),
                         y->between + sensor * y->hours.n_columns, &y->cells);
}

void orl_block_direct(const struct orl_year *y, size_t sensor, uint32_t part, float *ret_lx)
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

int orl_block_rows_make(struct orl_year *y)
{
    struct orl_crew *crew = y->env->run->crew;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    memset(y->error_sums, 0, y->hours.n_tiles * y->count * ORL_ERROR_BANDS * sizeof *y->error_sums);
    memset(y->between, 0, y->count * y->hours.n_columns * sizeof *y->between);
    int code = orl_crew_try(crew, y->count, fill_factors, y);
    if (code == 0)
        code = orl_crew_try(crew, y->hours.n_tiles, multiply_tile, y);
    return code == 0 ? orl_crew_try(crew, y->count, find_coherence, y) : code;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Lists the suns that each part needs, so that BSDF panes are sampled for these only. If sunlight
 * is stored for later jobs, all suns are needed. */
static int list_wanted_suns(struct orl_year *y)
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

static int make_sums(struct orl_year *y)
{
    const size_t n = y->block;
    const size_t lights = n * y->n_parts;
    const bool sun_only = orl_year_is_sun_only(y);
    y->sums = (struct orl_block_sums){.n_sensors = n,
                                      .n_parts = y->n_parts,
                                      .n_nodes = sun_only ? 0 : y->nodes.count,
                                      .n_beams = y->n_beams,
                                      .n_suns = y->hours.suns.count};
    if (orl_block_sums_init(&y->sums) < 0 || list_wanted_suns(y) < 0 || find_parts_of_beams(y) < 0)
        return ORL_ERR_NOMEM;
    y->lit = calloc(lights + 1, sizeof *y->lit);
    y->factors = malloc((lights + 1) * sizeof *y->factors);
    y->factor_nodes =
        malloc((lights * (ORL_ANNUAL_BATCHES + 1) * y->sums.n_nodes + 1) * sizeof *y->factor_nodes);
    y->beams = calloc(n + 1, sizeof *y->beams);
    y->beam_factors =
        malloc((n * (ORL_ANNUAL_BATCHES + 1) * y->n_beams + 1) * sizeof *y->beam_factors);
    y->lot_factors = malloc((n * ORL_SUN_MAP_LOTS * y->n_beams + 1) * sizeof *y->lot_factors);
    y->beam_lists = malloc((n * y->n_beams + 1) * sizeof *y->beam_lists);
    return y->lit && y->factors && y->factor_nodes && y->beams && y->beam_factors &&
                   y->lot_factors && y->beam_lists
               ? 0
               : ORL_ERR_NOMEM;
}

static int make_errors(struct orl_year *y)
{
    const size_t bands = y->block * y->hours.n_tiles * ORL_ERROR_BANDS;
    y->between = malloc((y->block * y->hours.n_columns + 1) * sizeof *y->between);
    y->error_sums = malloc((bands + 1) * sizeof *y->error_sums);
    if (!y->between || !y->error_sums)
        return ORL_ERR_NOMEM;
    return orl_sun_cells_init(&y->cells, &y->hours, &y->terms);
}

int orl_block_rows_init(struct orl_year *y)
{
    const size_t floats = y->block * ORL_YEAR_ROWS * y->hours.n_columns;
    y->rows = malloc((floats + 1) * sizeof *y->rows);
    if (!y->rows || make_sums(y) < 0)
        return ORL_ERR_NOMEM;
    return orl_year_is_sun_only(y) ? 0 : make_errors(y);
}

void orl_block_rows_done(struct orl_year *y)
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
    free(y->beam_lists);
    free(y->between);
    free(y->error_sums);
    orl_sun_cells_done(&y->cells);
    free(y->rows);
}
