#include "annual/coefficients/sensor_chunks.h"

#include <string.h>

/* ---- Coefficients ---------------------------------------------------------------------------- */

/* Collects the sums of a sensor's batches for a window group; returns false if there are none. */
static bool coefficients_of(const struct orl_year *y, size_t sensor, uint32_t window_group,
                            struct orl_annual_coefficients *ret)
{
    bool any = false;
    *ret = (struct orl_annual_coefficients){.samples = y->batch_samples,
                                            .n_nodes = y->chunk.sums.n_nodes};
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_path_sums sums = orl_chunk_sums_of(&y->chunk.sums, sensor, b);
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
        const double *beams = orl_chunk_sums_of(&y->chunk.sums, sensor, b).beams;
        for (size_t i = 0; i < y->n_beams; i++)
            if (beams[i] > 0)
                lit[y->chunk.window_group_of_beam[i]] = true;
    }
}

/* Fills the sensor's beams of lit window groups. */
static void fill_beams(struct orl_year *y, size_t sensor, const bool *lit)
{
    const size_t n = y->n_beams;
    uint32_t *which = y->chunk.beam_lists + sensor * n;
    struct orl_annual_beam_coefficients coefficients = {
        .samples = y->batch_samples, .which = which, .n_beams = n};
    for (uint32_t i = 0; i < n; i++)
        if (lit[y->chunk.window_group_of_beam[i]])
            which[coefficients.n_which++] = i;
    for (uint32_t b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const struct orl_path_sums sums = orl_chunk_sums_of(&y->chunk.sums, sensor, b);
        coefficients.beams[b] = sums.beams;
        coefficients.photon_batches[b] = sums.photon_batches;
    }
    orl_annual_beams_fill(&y->chunk.beams[sensor], &coefficients,
                          y->chunk.beam_values + sensor * (ORL_ANNUAL_BATCHES + 1) * n,
                          y->chunk.photon_batch_values + sensor * ORL_SUN_PHOTON_BATCHES * n);
}

static void fill_coefficients(void *arg, size_t sensor, uint32_t member)
{
    struct orl_year *y = arg;
    struct orl_year_chunk *c = &y->chunk;
    const size_t number = c->first + sensor;
    bool *lit = c->lit + sensor * y->n_window_groups;
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
        orl_sparse_coefficients_fill(&c->sparse[at], &y->bins, &coefficients,
                                     c->node_values +
                                         at * (ORL_ANNUAL_BATCHES + 1) * coefficients.n_nodes);
        if (y->result->coefficients)
            orl_sparse_coefficients_expand(&c->sparse[at],
                                           y->result->coefficients + number * ORL_ANNUAL_PATCHES);
    }
    orl_overcast_illuminance(overcast, &y->result->overcast[number],
                             &y->result->overcast_se[number]);
    fill_beams(y, sensor, lit);
}

/* Collects the light of a window group at a sensor; returns false if there is none. */
static bool light_of(const struct orl_year *y, size_t sensor, uint32_t window_group,
                     struct orl_window_group_light *ret)
{
    const struct orl_sensor_sunlight suns = orl_chunk_suns_of(&y->chunk.sums, sensor);
    const size_t at = sensor * y->n_window_groups + window_group;
    *ret = (struct orl_window_group_light){.window_group = window_group,
                                           .sparse = y->chunk.lit[at] ? &y->chunk.sparse[at] : NULL,
                                           .beams = &y->chunk.beams[sensor],
                                           .wanted = orl_year_wanted(y, window_group)};
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
    const struct orl_year_chunk *c = &y->chunk;
    (void)member;
    for (size_t i = 0; i < c->count; i++) {
        const struct orl_annual_columns row = {
            orl_year_row_of(y, i, ORL_YEAR_TOTAL), orl_year_row_of(y, i, ORL_YEAR_DIRECT),
            orl_year_row_of(y, i, ORL_YEAR_SE), c->interpolation_error + i * y->hours.n_columns,
            &c->error_sums[(tile * c->count + i) * ORL_ERROR_BANDS]};
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
    y->result->coherence[y->chunk.first + sensor] = orl_coherence_of(
        y->chunk.error_sums + sensor * ORL_ERROR_BANDS, y->hours.n_tiles, y->chunk.count,
        orl_year_row_of(y, sensor, ORL_YEAR_TOTAL),
        y->chunk.interpolation_error + sensor * y->hours.n_columns, &y->chunk.cells);
}

void orl_chunk_direct_sunlight(const struct orl_year *y, size_t sensor, uint32_t window_group,
                               float *ret_lx)
{
    const struct orl_sensor_sunlight suns = orl_chunk_suns_of(&y->chunk.sums, sensor);
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
    const struct orl_year_chunk *c = &y->chunk;
    struct orl_thread_pool *pool = y->env->run->pool;
    const size_t columns = c->count * y->hours.n_columns;
    memset(c->rows, 0, columns * ORL_YEAR_ROWS * sizeof *c->rows);
    memset(c->error_sums, 0, y->hours.n_tiles * c->count * ORL_ERROR_BANDS * sizeof *c->error_sums);
    memset(c->interpolation_error, 0, columns * sizeof *c->interpolation_error);
    int code = orl_parallel_try(pool, c->count, fill_coefficients, y);
    if (code == 0)
        code = orl_parallel_try(pool, y->hours.n_tiles, multiply_tile, y);
    return code == 0 ? orl_parallel_try(pool, c->count, find_coherence, y) : code;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Lists the suns that each window group needs, so that BSDF panes are sampled for these only. If
 * sunlight is stored for later jobs, all suns are needed. */
static void list_wanted_suns(struct orl_year *y)
{
    const struct orl_year_window_groups *window_groups = y->overrides->window_groups;
    const size_t suns = y->hours.suns.count;
    if (!window_groups || !window_groups->wanted || !window_groups->direct_as_wanted ||
        y->cache.store)
        return;
    unsigned char *wanted = orl_arrays_new(&y->arrays, y->n_window_groups * suns, sizeof *wanted);
    y->chunk.wanted_suns = wanted;
    for (uint32_t window_group = 0; wanted && window_group < y->n_window_groups; window_group++)
        for (size_t c = 0; c < y->hours.n_columns; c++)
            if (y->hours.sun_of_column[c].normal_lx > 0 && orl_year_wanted(y, window_group)[c])
                wanted[window_group * suns + y->hours.sun_of_column[c].sun] = 1;
}

static void find_window_groups_of_beams(struct orl_year *y)
{
    uint16_t *of_beam = orl_arrays_new(&y->arrays, y->n_beams, sizeof *of_beam);
    y->chunk.window_group_of_beam = of_beam;
    for (size_t sun = 0; of_beam && y->n_beams > 0 && sun < y->hours.suns.count; sun++)
        for (uint32_t window_group = 0; window_group < y->n_window_groups; window_group++) {
            const struct orl_sun_weight_range range =
                orl_sun_weights_of_beams(&y->sun_weights, sun, window_group);
            for (uint32_t i = range.first; i < range.end; i++)
                of_beam[y->sun_weights.which[i]] = (uint16_t)window_group;
        }
}

int orl_chunk_rows_init(struct orl_year *y)
{
    struct orl_year_chunk *c = &y->chunk;
    struct orl_arrays *arrays = &y->arrays;
    const bool sun_only = y->overrides->sun_only;
    const size_t n = c->size, lights = n * y->n_window_groups, columns = n * y->hours.n_columns;
    const size_t n_nodes = sun_only ? 0 : y->nodes.count, means = ORL_ANNUAL_BATCHES + 1;
    c->sums = (struct orl_chunk_sums){.n_sensors = n,
                                      .n_window_groups = y->n_window_groups,
                                      .n_nodes = n_nodes,
                                      .n_beams = y->n_beams,
                                      .n_suns = y->hours.suns.count};
    orl_chunk_sums_init(&c->sums, arrays);
    list_wanted_suns(y);
    find_window_groups_of_beams(y);
    c->rows = orl_arrays_new(arrays, columns * ORL_YEAR_ROWS, sizeof *c->rows);
    c->lit = orl_arrays_new(arrays, lights, sizeof *c->lit);
    c->sparse = orl_arrays_new(arrays, lights, sizeof *c->sparse);
    c->node_values = orl_arrays_new(arrays, lights * means * n_nodes, sizeof *c->node_values);
    c->beams = orl_arrays_new(arrays, n, sizeof *c->beams);
    c->beam_values = orl_arrays_new(arrays, n * means * y->n_beams, sizeof *c->beam_values);
    c->photon_batch_values = orl_arrays_new(arrays, n * ORL_SUN_PHOTON_BATCHES * y->n_beams,
                                            sizeof *c->photon_batch_values);
    c->beam_lists = orl_arrays_new(arrays, n * y->n_beams, sizeof *c->beam_lists);
    if (sun_only)
        return arrays->failed ? ORL_ERR_NOMEM : 0;
    c->interpolation_error = orl_arrays_new(arrays, columns, sizeof *c->interpolation_error);
    c->error_sums =
        orl_arrays_new(arrays, n * y->hours.n_tiles * ORL_ERROR_BANDS, sizeof *c->error_sums);
    return orl_sun_cells_init(&c->cells, arrays, &y->hours, &y->sun_weights);
}
