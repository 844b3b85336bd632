/* What a grid has in every step of the year. */
#include <oriel/annual_report.h>

#include <math.h>

#include "base/sum.h"

static float value_of(const struct orl_annual_rows *rows, enum orl_annual_series series,
                      double threshold_lx, size_t column)
{
    struct orl_sum sum = {0}, area = {0};
    for (size_t i = 0; i < rows->n_sensors; i++) {
        const double lx = rows->total_lx[i * rows->n_columns + column];
        orl_sum_add(&area, rows->area[i]);
        orl_sum_add(&sum,
                    rows->area[i] * (series == ORL_SERIES_MEAN ? lx : 100 * (lx >= threshold_lx)));
    }
    return rows->n_sensors > 0 ? (float)(orl_sum_value(&sum) / orl_sum_value(&area)) : 0;
}

void orl_annual_series_of(const struct orl_annual_report *report,
                          const struct orl_annual_result *result, size_t grid,
                          enum orl_annual_series series, double threshold_lx, float *ret_values)
{
    const struct orl_annual_year *year = &report->year;
    const struct orl_annual_rows rows = orl_annual_rows_of(report, result, grid);
    for (uint32_t i = 0; i < year->steps.count; i++)
        ret_values[i] = year->measured[i] ? ORL_SUN_DOWN : NAN;
    for (size_t k = 0; k < year->n_columns; k++)
        ret_values[year->step_of_column[k]] = value_of(&rows, series, threshold_lx, k);
}
