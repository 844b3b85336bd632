#include "annual/coefficients/sensor_chunks.h"

#include <stdlib.h>
#include <string.h>

/* ---- Coefficients ---------------------------------------------------------------------------- */

/* Collects the sums of a sensor's batches for a window group; returns false if there are none. */
static bool coefficients_of(const struct orl_year *y, size_t sensor, uint32_t window_group,
                            struct orl_annual_coefficients *ret)
{
    bool any = false;
    *ret =
        (struct orl_annual_coefficients){.samples = y->batch_samples, .n_nodes = y->sums.n_nodes};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_path_sums sums = orl_chunk_sums_of(&y->sums, sensor, b);
        if (!sums.lit[window_group])
            continue;
        ret->bins[b] = sums.bins + (size_t)window_group * ORL_BINS;
        ret->nodes[b] = sums.nodes + window_group * sums.n_nodes;
        any = true;
    }
    return any;
}

/* Marks the window groups of beams that reach a sensor. */
static void mark_beams(const struct orl_year *y, size_t sensor, bool *lit)
{
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const double *beams = orl_chunk_sums_of(&y->sums, sensor, b).beams;
        for (size_t i = 0; i < y->n_beams; i++)
            if (beams[i] > 0)
                lit[y->window_group_of_beam[i]] = true;
    }
}

/* Fills the sensor's beams of lit window groups. */
static void fill_beams(struct orl_year *y, size_t sensor, const bool *lit)
{
    const size_t n = y->n_beams;
    uint32_t *which = y->beam_lists + sensor * n;
    struct orl_annual_beam_coefficients coefficients = {
        .samples = y->batch_samples, .which = which, .n_beams = n};
    for (uint32_t i = 0; i < n; i++)
        if (lit[y->window_group_of_beam[i]])
            which[coefficients.n_which++] = i;
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_path_sums sums = orl_chunk_sums_of(&y->sums, sensor, b);
        coefficients.beams[b] = sums.beams;
        coefficients.photon_batches[b] = sums.photon_batches;
    }
    orl_annual_beams_fill(&y->beams[sensor], &coefficients,
                          y->beam_values + sensor * (ORL_ANNUAL_BATCHES + 1) * n,
                          y->photon_batch_values + sensor * ORL_SUN_PHOTON_BATCHES * n);
}

static void fill_coefficients(void *arg, size_t sensor, uint32_t member)
{
    struct orl_year *y = arg;
    bool *lit = y->lit + sensor * y->n_window_groups;
    double overcast[ORL_ANNUAL_BATCHES] = {0};
    (void)member;
    memset(lit, 0, y->n_window_groups * sizeof *lit);
    mark_beams(y, sensor, lit);
    for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++) {
        const size_t at = sensor * y->n_window_groups + window_group;
        struct orl_annual_coefficients coefficients;
        lit[window_group] =
            coefficients_of(y, sensor, window_group, &coefficients) || lit[window_group];
        if (!lit[window_group])
            continue;
        orl_overcast_add(&y->overcast, &coefficients, overcast);
        orl_sparse_coefficients_fill(&y->sparse[at], &y->bins, &coefficients,
                                     y->node_values +
                                         at * (ORL_ANNUAL_BATCHES + 1) * coefficients.n_nodes);
        if (y->result->coefficients)
            orl_sparse_coefficients_expand(
                &y->sparse[at], y->result->coefficients + (y->first + sensor) * ORL_ANNUAL_PATCHES);
    }
    orl_overcast_illuminance(overcast, &y->result->overcast[y->first + sensor],
                             &y->result->overcast_se[y->first + sensor]);
    fill_beams(y, sensor, lit);
}

/* Collects the light of a window group at a sensor; returns false if there is none. */
static bool light_of(const struct orl_year *y, size_t sensor, uint32_t window_group,
                     struct orl_window_group_light *ret)
{
    const struct orl_sensor_sunlight suns = orl_chunk_suns_of(&y->sums, sensor);
    const struct orl_year_window_groups *window_groups =
        y->overrides ? y->overrides->window_groups : NULL;
    const size_t at = sensor * y->n_window_groups + window_group;
    *ret = (struct orl_window_group_light){.window_group = window_group,
                                           .sparse = y->lit[at] ? &y->sparse[at] : NULL,
                                           .beams = &y->beams[sensor],
                                           .wanted = window_groups && window_groups->wanted
                                                         ? window_groups->wanted +
                                                               window_group * y->hours.n_columns
                                                         : NULL};
    if (suns.lit[window_group]) {
        ret->by_sun = orl_sensor_sunlight_row(&suns, window_group, ORL_SUNLIGHT_DIRECT);
        ret->mirrored = orl_sensor_sunlight_row(&suns, window_group, ORL_SUNLIGHT_MIRRORED);
        ret->squares = orl_sensor_sunlight_row(&suns, window_group, ORL_SUNLIGHT_VARIANCE);
    }
    return ret->sparse || ret->by_sun;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static void multiply_tile(void *arg, size_t tile, uint32_t member)
{
    const struct orl_year *y = arg;
    (void)member;
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_annual_columns row = {
            orl_year_row_of(y, i, ORL_YEAR_TOTAL), orl_year_row_of(y, i, ORL_YEAR_DIRECT),
            orl_year_row_of(y, i, ORL_YEAR_SE), y->interpolation_error + i * y->hours.n_columns,
            &y->error_sums[(tile * y->count + i) * ORL_ERROR_BANDS]};
        struct orl_window_group_light lights[ORL_SHADES_MOST_GROUPS + 1];
        size_t n = 0;
        for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++)
            n += light_of(y, i, window_group, &lights[n]);
        orl_annual_apply_weather(&row, lights, n, &y->hours, &y->sun_weights, tile);
    }
}

static void find_coherence(void *arg, size_t sensor, uint32_t member)
{
    const struct orl_year *y = arg;
    (void)member;
    y->result->coherence[y->first + sensor] =
        orl_coherence_of(y->error_sums + sensor * ORL_ERROR_BANDS, y->hours.n_tiles, y->count,
                         orl_year_row_of(y, sensor, ORL_YEAR_TOTAL),
                         y->interpolation_error + sensor * y->hours.n_columns, &y->cells);
}

void orl_chunk_direct_sunlight(const struct orl_year *y, size_t sensor, uint32_t window_group,
                               float *ret_lx)
{
    const struct orl_sensor_sunlight suns = orl_chunk_suns_of(&y->sums, sensor);
    const float *by_sun = orl_sensor_sunlight_row(&suns, window_group, ORL_SUNLIGHT_DIRECT);
    for (size_t c = 0; c < y->hours.n_columns; c++) {
        const struct orl_column_sun *sun = &y->hours.sun_of_column[c];
        ret_lx[c] = suns.lit[window_group] && sun->normal_lx > 0
                        ? (float)(sun->normal_lx * (double)by_sun[sun->sun])
                        : 0;
    }
}

int orl_chunk_rows_compute(struct orl_year *y)
{
    struct orl_thread_pool *pool = y->env->run->pool;
    memset(y->rows, 0, y->count * ORL_YEAR_ROWS * y->hours.n_columns * sizeof *y->rows);
    memset(y->error_sums, 0, y->hours.n_tiles * y->count * ORL_ERROR_BANDS * sizeof *y->error_sums);
    memset(y->interpolation_error, 0,
           y->count * y->hours.n_columns * sizeof *y->interpolation_error);
    int code = orl_parallel_try(pool, y->count, fill_coefficients, y);
    if (code == 0)
        code = orl_parallel_try(pool, y->hours.n_tiles, multiply_tile, y);
    return code == 0 ? orl_parallel_try(pool, y->count, find_coherence, y) : code;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Lists the suns that each window group needs, so that BSDF panes are sampled for these only. If
 * sunlight is stored for later jobs, all suns are needed. */
static int list_wanted_suns(struct orl_year *y)
{
    const struct orl_year_window_groups *window_groups =
        y->overrides ? y->overrides->window_groups : NULL;
    const size_t suns = y->hours.suns.count;
    if (!window_groups || !window_groups->wanted || !window_groups->direct_as_wanted ||
        y->cache.store)
        return 0;
    y->wanted_suns = calloc(y->n_window_groups * suns + 1, sizeof *y->wanted_suns);
    if (!y->wanted_suns)
        return ORL_ERR_NOMEM;
    for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++)
        for (size_t c = 0; c < y->hours.n_columns; c++)
            if (y->hours.sun_of_column[c].normal_lx > 0 &&
                window_groups->wanted[window_group * y->hours.n_columns + c])
                y->wanted_suns[window_group * suns + y->hours.sun_of_column[c].sun] = 1;
    return 0;
}

static int find_window_groups_of_beams(struct orl_year *y)
{
    y->window_group_of_beam = calloc(y->n_beams + 1, sizeof *y->window_group_of_beam);
    for (size_t sun = 0; y->window_group_of_beam && y->n_beams > 0 && sun < y->hours.suns.count;
         sun++)
        for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++) {
            const struct orl_sun_weight_range range =
                orl_sun_weights_of_beams(&y->sun_weights, sun, window_group);
            for (uint32_t i = range.first; i < range.end; i++)
                y->window_group_of_beam[y->sun_weights.which[i]] = (uint16_t)window_group;
        }
    return y->window_group_of_beam ? 0 : ORL_ERR_NOMEM;
}

static int make_sums(struct orl_year *y)
{
    const size_t n = y->chunk_size;
    const size_t lights = n * y->n_window_groups;
    const bool sun_only = orl_year_is_sun_only(y);
    y->sums = (struct orl_chunk_sums){.n_sensors = n,
                                      .n_window_groups = y->n_window_groups,
                                      .n_nodes = sun_only ? 0 : y->nodes.count,
                                      .n_beams = y->n_beams,
                                      .n_suns = y->hours.suns.count};
    if (orl_chunk_sums_init(&y->sums) < 0 || list_wanted_suns(y) < 0 ||
        find_window_groups_of_beams(y) < 0)
        return ORL_ERR_NOMEM;
    y->lit = calloc(lights + 1, sizeof *y->lit);
    y->sparse = malloc((lights + 1) * sizeof *y->sparse);
    y->node_values =
        malloc((lights * (ORL_ANNUAL_BATCHES + 1) * y->sums.n_nodes + 1) * sizeof *y->node_values);
    y->beams = calloc(n + 1, sizeof *y->beams);
    y->beam_values =
        malloc((n * (ORL_ANNUAL_BATCHES + 1) * y->n_beams + 1) * sizeof *y->beam_values);
    y->photon_batch_values =
        malloc((n * ORL_SUN_PHOTON_BATCHES * y->n_beams + 1) * sizeof *y->photon_batch_values);
    y->beam_lists = malloc((n * y->n_beams + 1) * sizeof *y->beam_lists);
    return y->lit && y->sparse && y->node_values && y->beams && y->beam_values &&
                   y->photon_batch_values && y->beam_lists
               ? 0
               : ORL_ERR_NOMEM;
}

static int make_errors(struct orl_year *y)
{
    const size_t bands = y->chunk_size * y->hours.n_tiles * ORL_ERROR_BANDS;
    y->interpolation_error =
        malloc((y->chunk_size * y->hours.n_columns + 1) * sizeof *y->interpolation_error);
    y->error_sums = malloc((bands + 1) * sizeof *y->error_sums);
    if (!y->interpolation_error || !y->error_sums)
        return ORL_ERR_NOMEM;
    return orl_sun_cells_init(&y->cells, &y->hours, &y->sun_weights);
}

int orl_chunk_rows_init(struct orl_year *y)
{
    const size_t floats = y->chunk_size * ORL_YEAR_ROWS * y->hours.n_columns;
    y->rows = malloc((floats + 1) * sizeof *y->rows);
    if (!y->rows || make_sums(y) < 0)
        return ORL_ERR_NOMEM;
    return orl_year_is_sun_only(y) ? 0 : make_errors(y);
}

void orl_chunk_rows_done(struct orl_year *y)
{
    orl_chunk_sums_done(&y->sums);
    free(y->wanted_suns);
    free(y->window_group_of_beam);
    free(y->lit);
    free(y->sparse);
    free(y->node_values);
    free(y->beams);
    free(y->beam_values);
    free(y->photon_batch_values);
    free(y->beam_lists);
    free(y->interpolation_error);
    free(y->error_sums);
    orl_sun_cells_done(&y->cells);
    free(y->rows);
}
