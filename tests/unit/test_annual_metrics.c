/* Annual metrics from hand-made arrays: thresholds met exactly, nights, leap years, areas. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/annual/annual_metrics.h>

#include "metrics/annual/annual_figures.h"
static const struct orl_annual_steps hourly = {8760, 1}, leap = {8784, 1}, halves = {17520, 2};

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

/* A year whose days have this number of lit hours from 6:00 on. */
struct year {
    struct orl_annual_period periods[ORL_WHEN_COUNT];
    uint32_t *step_of;
    size_t n;
};

static void make_year(struct year *year, const struct orl_annual_steps *steps, unsigned lit)
{
    unsigned char *marks = malloc(steps->count);
    double *light = calloc(steps->count, sizeof *light);
    struct orl_occupancy use;
    year->step_of = calloc(steps->count, sizeof *year->step_of);
    assert_true(marks && light && year->step_of);
    year->n = 0;
    for (uint32_t i = 0; i < steps->count; i++) {
        const uint32_t hour = i / steps->per_hour % 24;
        if (hour >= 6 && hour < 6 + lit) {
            light[i] = 1e4 + hour;
            year->step_of[year->n++] = i;
        }
    }
    orl_occupancy_init(&use);
    orl_occupancy_mark(&use, steps, marks);
    assert_int_equal(orl_annual_period_make(marks, steps, year->step_of, year->n,
                                            &year->periods[ORL_WHEN_OCCUPIED], NULL),
                     0);
    assert_int_equal(orl_annual_daylight_mark(light, NULL, steps, marks, NULL), 0);
    assert_int_equal(orl_annual_period_make(marks, steps, year->step_of, year->n,
                                            &year->periods[ORL_WHEN_DAYLIGHT], NULL),
                     0);
    assert_int_equal(orl_annual_period_make(NULL, steps, year->step_of, year->n,
                                            &year->periods[ORL_WHEN_ALWAYS], NULL),
                     0);
    free(marks);
    free(light);
}

static void free_year(struct year *year)
{
    for (int i = 0; i < ORL_WHEN_COUNT; i++)
        orl_annual_period_done(&year->periods[i]);
    free(year->step_of);
}

static double value_of(const struct year *year, enum orl_metric_kind kind, double low, double high,
                       const float *row)
{
    const struct orl_annual_metric metric = {kind, ORL_WHEN_OCCUPIED, low, high};
    const struct orl_annual_light light = {.total_lx = row, .direct_lx = row};
    struct orl_annual_value value;
    orl_annual_evaluate(&metric, &year->periods[ORL_WHEN_OCCUPIED], &light, &value);
    assert_true(isnan(value.low) && isnan(value.high));
    return value.value;
}

/* Every occupied hour has one value: a threshold met exactly counts, except for "more than". */
static void test_thresholds_met_exactly(void **state)
{
    struct year year;
    (void)state;
    make_year(&year, &hourly, 12);
    float *row = calloc(year.n, sizeof *row);
    assert_non_null(row);
    for (size_t i = 0; i < year.n; i++)
        row[i] = 300;
    assert_near(value_of(&year, ORL_METRIC_DA, 300, 0, row), 100, 1e-12);
    assert_near(value_of(&year, ORL_METRIC_CDA, 300, 0, row), 100, 1e-12);
    assert_near(value_of(&year, ORL_METRIC_UDI, 300, 3000, row), 100, 1e-12);
    assert_near(value_of(&year, ORL_METRIC_UDI, 100, 300, row), 100, 1e-12);
    assert_near(value_of(&year, ORL_METRIC_UDI_PART, 100, 300, row), 0, 0);
    assert_near(value_of(&year, ORL_METRIC_UDI_LOWER, 300, 0, row), 0, 0);
    assert_near(value_of(&year, ORL_METRIC_UDI_UPPER, 300, 0, row), 0, 0);
    assert_near(value_of(&year, ORL_METRIC_DIRECT_HOURS, 300, 0, row), 0, 0);
    assert_near(value_of(&year, ORL_METRIC_DIRECT_HOURS, 299.99, 0, row), 3650, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_HOURS, 300, 0, row), 3650, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_MEAN, 0, 0, row), 300, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_CUMULATIVE, 0, 0, row), 300 * 3650, 1e-6);
    for (size_t i = 0; i < year.n; i++)
        row[i] = 150;
    assert_near(value_of(&year, ORL_METRIC_CDA, 300, 0, row), 50, 1e-12);
    assert_near(value_of(&year, ORL_METRIC_DA, 300, 0, row), 0, 0);
    free(row);
    free_year(&year);
}

/* Hours without a column count as dark; the parts of UDI sum to the whole. */
static void test_nights_count(void **state)
{
    struct year year;
    (void)state;
    make_year(&year, &hourly, 7); /* 6 to 13: 5 of 10 occupied hours */
    float *row = calloc(year.n, sizeof *row);
    assert_non_null(row);
    for (size_t i = 0; i < year.n; i++)
        row[i] = year.step_of[i] % 24 == 12 ? 5000 : 200;
    assert_near(year.periods[ORL_WHEN_OCCUPIED].hours, 3650, 0);
    assert_near(value_of(&year, ORL_METRIC_UDI_LOWER, 100, 0, row), 50, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_UDI_PART, 100, 300, row), 40, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_UDI, 100, 3000, row), 40, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_UDI_UPPER, 3000, 0, row), 10, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_CDA, 400, 0, row), 30, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_MEAN, 0, 0, row), (4 * 200 + 5000) / 10.0, 1e-9);
    memset(row, 0, year.n * sizeof *row);
    assert_near(value_of(&year, ORL_METRIC_UDI_LOWER, 100, 0, row), 100, 1e-9);
    assert_near(value_of(&year, ORL_METRIC_DA, 300, 0, row), 0, 0);
    assert_near(value_of(&year, ORL_METRIC_DIRECT_HOURS, 0, 0, row), 0, 0);
    free(row);
    free_year(&year);
}

/* Returns the share for one sensor with that number of hours at a value: 0 or 100 %. */
static double share_with(const struct year *year, struct orl_annual_figure figure, size_t hours,
                         float lx)
{
    const struct orl_annual_period *period = &year->periods[figure.metric.when];
    float *row = calloc(year->n, sizeof *row);
    struct orl_annual_area area;
    assert_true(row && hours <= period->n_columns);
    for (size_t i = 0; i < hours; i++)
        row[period->columns[i]] = lx;
    const struct orl_annual_rows rows = {
        .total_lx = row, .direct_lx = row, .n_sensors = 1, .n_columns = year->n};
    assert_int_equal(orl_annual_figure_of(&figure, year->periods, &rows, &area, NULL), 0);
    free(row);
    return area.value.value;
}

static void test_hours_met_exactly(void **state)
{
    const struct orl_annual_figure sda = {
        ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50};
    const struct orl_annual_figure ase = {
        ORL_AGGREGATE_SHARE, {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0}, 250};
    const struct orl_annual_figure provision = {
        ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, ORL_WHEN_DAYLIGHT, 300, 0}, 50};
    struct year year;
    (void)state;
    make_year(&year, &hourly, 12);
    assert_near(share_with(&year, sda, 1825, 300), 100, 0);
    assert_near(share_with(&year, sda, 1824, 300), 0, 0);
    assert_near(share_with(&year, sda, 1825, nextafterf(300, 0)), 0, 0);
    assert_near(share_with(&year, ase, 250, nextafterf(1000, 2000)), 100, 0);
    assert_near(share_with(&year, ase, 249, 90000), 0, 0);
    assert_near(share_with(&year, ase, 3650, 1000), 0, 0);
    assert_near(year.periods[ORL_WHEN_DAYLIGHT].hours, 4380, 0);
    assert_near(share_with(&year, provision, 2190, 300), 100, 0);
    assert_near(share_with(&year, provision, 2189, 300), 0, 0);
    free_year(&year);
    make_year(&year, &leap, 12); /* 3660 and 4392 hours */
    assert_near(share_with(&year, sda, 1830, 300), 100, 0);
    assert_near(share_with(&year, sda, 1829, 300), 0, 0);
    assert_near(share_with(&year, provision, 2196, 300), 100, 0);
    assert_near(share_with(&year, provision, 2195, 300), 0, 0);
    free_year(&year);
    make_year(&year, &halves, 12); /* steps of half an hour */
    assert_near(share_with(&year, ase, 500, 1001), 100, 0);
    assert_near(share_with(&year, ase, 499, 1001), 0, 0);
    free_year(&year);
}

/* ---- Areas ----------------------------------------------------------------------------------- */

static struct orl_annual_value figure_over(enum orl_annual_aggregate aggregate,
                                           const struct orl_annual_rows *rows)
{
    uint32_t columns[2] = {0, 1};
    struct orl_annual_period periods[ORL_WHEN_COUNT] = {[ORL_WHEN_OCCUPIED] = {columns, 2, 1, 2}};
    const struct orl_annual_figure figure = {
        aggregate, {ORL_METRIC_MEAN, ORL_WHEN_OCCUPIED, 0, 0}, 150};
    struct orl_annual_area area;
    assert_int_equal(orl_annual_figure_of(&figure, periods, rows, &area, NULL), 0);
    return area.value;
}

/* Two sensors of 100 and 300 lx, the second with three times the area; errors of 3 and 4 lx. */
static void test_averages_and_the_worst(void **state)
{
    const float total[4] = {100, 100, 300, 300}, errors[4] = {3, 3, 4, 4};
    const double areas[2] = {1, 3}, t = 2.131449545559323;
    const struct orl_annual_rows rows = {
        .total_lx = total, .total_error_lx = errors, .n_sensors = 2, .n_columns = 2, .area = areas};
    const double up = 100 * expm1(t * 0.03), up_3 = 3 * 300 * expm1(t * 4 / 300.0);
    const double down = -100 * expm1(-t * 0.03), down_3 = -3 * 300 * expm1(-t * 4 / 300.0);
    const double both = sqrt(9 + 144) / 4; /* standard error of the mean illuminance */
    struct orl_annual_value value = figure_over(ORL_AGGREGATE_AVERAGE, &rows);
    (void)state;
    assert_near(value.value, 250, 1e-9);
    assert_near(value.high - value.value, hypot(up, up_3) / 4, 1e-6);
    assert_near(value.value - value.low, hypot(down, down_3) / 4, 1e-6);
    value = figure_over(ORL_AGGREGATE_OF_MEAN, &rows);
    assert_near(value.value, 250, 1e-5);
    assert_near(value.high, 250 * exp(t * both / 250), 1e-4);
    value = figure_over(ORL_AGGREGATE_LEAST, &rows);
    assert_near(value.value, 100, 1e-9);
    assert_near(value.high, 100 * exp(t * 0.03), 1e-6);
    assert_near(orl_student_above(-log(value.low / 100) / 0.03), 1 - sqrt(0.975), 1e-9);
    value = figure_over(ORL_AGGREGATE_SHARE, &rows);
    assert_near(value.value, 75, 1e-9);
    assert_near(value.low, 75, 1e-9);
}

/* Daylight factors of 1, 2, 2 and 5 %; the second and last have errors of a tenth. */
static void test_daylight_factors(void **state)
{
    const float overcast[4] = {100, 200, 200, 500}, errors[4] = {0, 20, 0, 50};
    const float total[4] = {0};
    const struct orl_annual_rows rows = {.total_lx = total,
                                         .overcast_lx = overcast,
                                         .overcast_error_lx = errors,
                                         .n_sensors = 4,
                                         .n_columns = 1};
    const struct orl_annual_period periods[ORL_WHEN_COUNT] = {{0}};
    const struct orl_annual_metric df = {ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0};
    const double t = 2.131449545559323;
    struct orl_annual_area area;
    (void)state;
    struct orl_annual_figure figure = {ORL_AGGREGATE_AVERAGE, df, 0};
    assert_int_equal(orl_annual_figure_of(&figure, periods, &rows, &area, NULL), 0);
    assert_near(area.value.value, 2.5, 1e-6);
    assert_near(area.value.high, 2.5 + hypot(2, 5) / 4 * expm1(t * 0.1), 1e-6);
    figure.aggregate = ORL_AGGREGATE_OF_MEAN;
    assert_int_equal(orl_annual_figure_of(&figure, periods, &rows, &area, NULL), 0);
    assert_near(area.value.value, 2.5, 1e-6);
    figure.aggregate = ORL_AGGREGATE_LEAST;
    assert_int_equal(orl_annual_figure_of(&figure, periods, &rows, &area, NULL), 0);
    assert_near(area.value.value, 1, 1e-6);
    figure =
        (struct orl_annual_figure){ORL_AGGREGATE_SHARE, df, 2}; /* two of them meet it exactly */
    assert_int_equal(orl_annual_figure_of(&figure, periods, &rows, &area, NULL), 0);
    assert_near(area.value.value, 75, 1e-9);
    assert_near(area.value.low, 50, 1e-9);
    assert_int_equal(area.open, 1);
}

static void test_refused_figures(void **state)
{
    const float total[1] = {1};
    const struct orl_annual_rows rows = {.total_lx = total, .n_sensors = 1, .n_columns = 1};
    const struct orl_annual_rows none = {.total_lx = total, .n_columns = 1};
    const struct orl_annual_period periods[ORL_WHEN_COUNT] = {{0}};
    const struct orl_annual_figure udi = {ORL_AGGREGATE_SHARE, {ORL_METRIC_UDI, 0, 100, 3000}, 50};
    const struct orl_annual_figure ase = {
        ORL_AGGREGATE_SHARE, {ORL_METRIC_DIRECT_HOURS, 0, 1, 0}, 50};
    const struct orl_annual_figure da = {ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, 0, 1, 0}, 50};
    struct orl_annual_area area;
    (void)state;
    assert_int_equal(orl_annual_figure_of(&udi, periods, &rows, &area, NULL), ORL_ERR_INVALID);
    assert_int_equal(orl_annual_figure_of(&ase, periods, &rows, &area, NULL), ORL_ERR_INVALID);
    assert_int_equal(orl_annual_figure_of(&da, periods, &none, &area, NULL), ORL_ERR_INVALID);
    const struct orl_annual_figure df = {ORL_AGGREGATE_AVERAGE, {ORL_METRIC_DF, 0, 0, 0}, 0};
    assert_int_equal(orl_annual_figure_of(&df, periods, &rows, &area, NULL), ORL_ERR_INVALID);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thresholds_met_exactly),
        cmocka_unit_test(test_nights_count),
        cmocka_unit_test(test_hours_met_exactly),
        cmocka_unit_test(test_averages_and_the_worst),
        cmocka_unit_test(test_daylight_factors),
        cmocka_unit_test(test_refused_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
