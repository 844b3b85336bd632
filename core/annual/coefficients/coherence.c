#include "annual/coefficients/apply_weather.h"

#include <stdlib.h>

struct cell_of {
    uint32_t cell, column;
};

static int by_cell(const void *a, const void *b)
{
    const struct cell_of *x = a, *y = b;
    if (x->cell != y->cell)
        return x->cell < y->cell ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* Lists columns with sun and the first node of each; returns their number. */
static size_t list_columns(const struct orl_hours *hours, const struct orl_sun_weights *sun_weights,
                           struct cell_of *ret)
{
    size_t n = 0;
    for (size_t c = 0; c < hours->n_columns; c++) {
        const struct orl_column_sun *of = &hours->sun_of_column[c];
        if (!(of->normal_lx > 0))
            continue;
        const struct orl_sun_weight_range nodes = orl_sun_weights_of_nodes(sun_weights, of->sun);
        ret[n++] = (struct cell_of){
            nodes.first < nodes.end ? sun_weights->which[nodes.first] : UINT32_MAX, (uint32_t)c};
    }
    return n;
}

int orl_sun_cells_init(struct orl_sun_cells *cells, struct orl_arrays *arrays,
                       const struct orl_hours *hours, const struct orl_sun_weights *sun_weights)
{
    struct cell_of *all = malloc((hours->n_columns + 1) * sizeof *all);
    cells->columns = orl_arrays_new(arrays, hours->n_columns, sizeof *cells->columns);
    cells->cells = orl_arrays_new(arrays, hours->n_columns, sizeof *cells->cells);
    if (!all || arrays->failed) {
        free(all);
        return ORL_ERR_NOMEM;
    }
    cells->count = list_columns(hours, sun_weights, all);
    qsort(all, cells->count, sizeof *all, by_cell);
    for (size_t i = 0; i < cells->count; i++) {
        cells->columns[i] = all[i].column;
        cells->cells[i] = all[i].cell;
    }
    free(all);
    return 0;
}

/* Squared standard error of a mean, from n deviations. */
static double square_of(const float *deviations, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += (double)deviations[i] * (double)deviations[i];
    return sum / (n * (n - 1.0));
}

/* Adds squared errors of interpolation to each band. Errors of hours between the same nodes are
 * summed before squaring. */
static void add_interpolation_errors(const float *total, const float *interpolation_error,
                                     const struct orl_sun_cells *cells,
                                     double squares[ORL_ERROR_BANDS])
{
    double sums[ORL_ERROR_BANDS] = {0};
    for (size_t i = 0; i < cells->count; i++) {
        const uint32_t column = cells->columns[i];
        sums[orl_error_band((double)total[column])] += (double)interpolation_error[column];
        if (i + 1 < cells->count && cells->cells[i + 1] == cells->cells[i])
            continue;
        for (int k = 0; k < ORL_ERROR_BANDS; k++) {
            squares[k] += sums[k] * sums[k];
            sums[k] = 0;
        }
    }
}

static struct orl_error_sums sum_tiles(const struct orl_error_sums *sums, size_t n_tiles,
                                       size_t stride)
{
    struct orl_error_sums all = {.errors = 0};
    for (size_t t = 0; t < n_tiles; t++) {
        const struct orl_error_sums *tile = &sums[t * stride];
        all.errors += tile->errors;
        all.squares += tile->squares;
        for (int b = 0; b < ORL_ANNUAL_BATCHES; b++)
            all.batches[b] += tile->batches[b];
        for (int photon_batch = 0; photon_batch < ORL_SUN_PHOTON_BATCHES; photon_batch++)
            all.photon_batches[photon_batch] += tile->photon_batches[photon_batch];
    }
    return all;
}

float orl_coherence_of(const struct orl_error_sums *sums, size_t n_tiles, size_t stride,
                       const float *total, const float *interpolation_error,
                       const struct orl_sun_cells *cells)
{
    double squares[ORL_ERROR_BANDS] = {0}, square = 0, most = 0;
    add_interpolation_errors(total, interpolation_error, cells, squares);
    for (int k = 0; k < ORL_ERROR_BANDS; k++) {
        const struct orl_error_sums band = sum_tiles(sums + k, n_tiles, stride * ORL_ERROR_BANDS);
        square += squares[k] + band.squares + square_of(band.batches, ORL_ANNUAL_BATCHES) +
                  square_of(band.photon_batches, ORL_SUN_PHOTON_BATCHES);
        most += band.errors * band.errors;
    }
    return most > 0 ? (float)fmin(sqrt(square / most), 1) : 0;
}
