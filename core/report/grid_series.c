/* Computes a grid's value in every step of the year. */
#include <oriel/annual/annual_report.h>

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

#include "base/statistics/sum.h"

/* Adds a sensor to the sum of each column. Rows of the result are read sequentially. */
static void add_sensor(const struct orl_annual_rows *rows, enum orl_annual_series series,
                       double threshold_lx, size_t sensor, struct orl_sum *sums)
{
    const float *row = &rows->total_lx[sensor * rows->n_columns];
    for (size_t k = 0; k < rows->n_columns; k++) {
        const double lx = row[k];
        orl_sum_add(&sums[k], rows->area[sensor] *
                                  (series == ORL_SERIES_MEAN ? lx : 100 * (lx >= threshold_lx)));
    }
}

int orl_annual_series_of(const struct orl_annual_report *report,
                         const struct orl_annual_result *result, size_t grid,
                         enum orl_annual_series series, double threshold_lx,
                         const atomic_bool *cancel, float *ret_values)
{
    const struct orl_annual_timeline *year = &report->year;
    const struct orl_annual_rows rows = orl_annual_rows_of(report, result, grid);
    struct orl_sum *sums = calloc(rows.n_columns + 1, sizeof *sums), area = {0};
    int code = sums ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < rows.n_sensors && code == 0; i++) {
        code = orl_is_cancelled(cancel) ? ORL_ERR_CANCELLED : 0;
        add_sensor(&rows, series, threshold_lx, i, sums);
        orl_sum_add(&area, rows.area[i]);
    }
    for (uint32_t i = 0; i < year->steps.count && code == 0; i++)
        ret_values[i] = year->measured[i] ? ORL_SUN_DOWN : NAN;
    for (size_t k = 0; k < year->n_columns && code == 0; k++)
        ret_values[year->step_of_column[k]] =
            rows.n_sensors > 0 ? (float)(orl_sum_value(&sums[k]) / orl_sum_value(&area)) : 0;
    free(sums);
    return code;
}
