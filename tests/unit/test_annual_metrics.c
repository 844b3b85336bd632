/*
 * Metrics of a year from arrays made by hand: thresholds met exactly, nights, leap years, darkness,
 * one sensor; shares of areas against binomial tables; how often intervals hold the truth; targets
 * in words.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/annual_metrics.h>

#include "base/random.h"
#include "metrics/annual/calendar.h"
#include "metrics/annual/chance.h"

static const struct orl_annual_steps hourly = {8760, 1}, leap = {8784, 1}, halves = {17520, 2};

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

static size_t count_marks(const unsigned char *marks, size_t n)
{
    size_t sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += marks[i];
    return sum;
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static void test_years(void **state)
{
    const struct orl_annual_steps odd = {8761, 1}, none = {0, 0};
    struct orl_calendar_day day;
    (void)state;
    assert_int_equal(orl_annual_steps_check(&hourly, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&leap, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&halves, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&odd, NULL), ORL_ERR_RANGE);
    assert_int_equal(orl_annual_steps_check(&none, NULL), ORL_ERR_RANGE);
    day = orl_calendar_day_of(&hourly, 59 * 24);
    assert_true(day.month == 3 && day.day == 1);
    day = orl_calendar_day_of(&leap, 59 * 24 + 23);
    assert_true(day.month == 2 && day.day == 29);
    day = orl_calendar_day_of(&leap, 8783);
    assert_true(day.month == 12 && day.day == 31);
    day = orl_calendar_day_of(&halves, 17519);
    assert_true(day.month == 12 && day.day == 31);
    assert_near(orl_calendar_hour_of(&halves, 17519), 23.75, 0);
}

/* LM-83's 3650 hours; weekdays of a year that begins on a Sunday; a night shift. */
static void test_occupancy_by_the_clock(void **state)
{
    unsigned char *marks = malloc(17520);
    struct orl_occupancy use;
    (void)state;
    assert_non_null(marks);
    orl_occupancy_init(&use);
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 3650);
    assert_int_equal(count_marks(marks, 8), 0);
    assert_true(marks[8] && marks[17] && !marks[18]);
    orl_occupancy_mark(&use, &leap, marks);
    assert_int_equal(count_marks(marks, 8784), 3660);
    orl_occupancy_mark(&use, &halves, marks);
    assert_int_equal(count_marks(marks, 17520), 7300);
    use.days = 0x1f;
    use.first_day = 6;
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 2600); /* 260 weekdays: 53 Sundays, 52 Saturdays */
    assert_int_equal(count_marks(marks, 24), 0);
    orl_occupancy_init(&use);
    use.from_h = 22;
    use.to_h = 6;
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 365 * 8);
    assert_true(marks[22] && marks[0] && !marks[6]);
    free(marks);
}

/* A schedule as DAYSIM writes it, weekdays 8 to 17, of hours or of half hours; or one column. */
static char *write_schedule(const struct orl_annual_steps *steps, bool times, size_t lines)
{
    char *text = malloc(32 * (lines + 3)), *at = text;
    assert_non_null(text);
    at += sprintf(at, "# a schedule\n%s\n\n", times ? "month,day,hour,occupancy" : "use");
    for (uint32_t i = 0; i < lines; i++) {
        const struct orl_calendar_day day = orl_calendar_day_of(steps, i % steps->count);
        const double hour = orl_calendar_hour_of(steps, i % steps->count);
        const bool used = hour > 8 && hour < 17;
        if (times)
            at += sprintf(at, "%d,%d,%.3f,%d\r\n", day.month, day.day, hour, used);
        else
            at += sprintf(at, "%s\n", used ? "0.95" : "0");
    }
    return text;
}

static int read_schedule(const struct orl_annual_steps *as, bool times, size_t lines,
                         const struct orl_annual_steps *year, unsigned char *marks,
                         struct orl_error *err)
{
    char *text = write_schedule(as, times, lines);
    const int code = orl_occupancy_read("use.csv", text, strlen(text), year, marks, err);
    free(text);
    return code;
}

static void test_occupancy_files(void **state)
{
    unsigned char *marks = malloc(17520);
    struct orl_error err = {0};
    (void)state;
    assert_non_null(marks);
    for (int times = 0; times < 2; times++) {
        assert_int_equal(read_schedule(&hourly, times, 8760, &hourly, marks, &err), 0);
        assert_int_equal(count_marks(marks, 8760), 365 * 9);
        assert_true(!marks[7] && marks[8] && marks[16] && !marks[17]);
        assert_int_equal(read_schedule(&hourly, times, 8760, &halves, marks, &err), 0);
        assert_int_equal(count_marks(marks, 17520), 365 * 18);
        assert_true(!marks[15] && marks[16] && marks[33] && !marks[34]);
        assert_int_equal(read_schedule(&hourly, times, 8759, &hourly, marks, &err), ORL_ERR_RANGE);
        assert_int_equal(read_schedule(&hourly, times, 8761, &hourly, marks, &err), ORL_ERR_RANGE);
        assert_int_equal(err.line, 8764);
    }
    assert_int_equal(read_schedule(&halves, true, 17520, &halves, marks, &err), 0);
    assert_int_equal(count_marks(marks, 17520), 365 * 18);
    /* A leap year's file for another year: the first day that is wrong is told. */
    assert_int_equal(read_schedule(&leap, true, 8784, &hourly, marks, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 4 + 59 * 24);
    assert_int_equal(orl_occupancy_read("x", "1\n2\nthree\n", 10, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(err.line, 3);
    assert_int_equal(orl_occupancy_read("x", "1,2\n", 4, &hourly, marks, &err), ORL_ERR_SYNTAX);
    assert_int_equal(orl_occupancy_read("x", "1\n1,1,1.5,1\n", 12, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(err.line, 2);
    assert_int_equal(orl_occupancy_read("x", "1,1,.5,1\n1\n", 11, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(orl_occupancy_read("x", "", 0, &hourly, marks, &err), ORL_ERR_RANGE);
    free(marks);
}

/* UTF-8's mark before the first number is not a line of words. */
static void test_marked_occupancy_file(void **state)
{
    char *text = malloc(3 + 2 * 8760 + 1);
    unsigned char *marks = malloc(8760);
    struct orl_error err = {0};
    (void)state;
    assert_true(text && marks);
    char *at = stpcpy(text, "\xef\xbb\xbf");
    for (int i = 0; i < 8760; i++)
        at = stpcpy(at, i == 0 ? "1\n" : "0\n");
    assert_int_equal(orl_occupancy_read("x", text, strlen(text), &hourly, marks, &err), 0);
    assert_int_equal(marks[0], 1);
    assert_int_equal(count_marks(marks, 8760), 1);
    assert_int_equal(orl_occupancy_read("x", text, strlen(text) - 2, &hourly, marks, &err),
                     ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "8759 lines"));
    assert_non_null(strstr(err.hint, "8760"));
    free(text);
    free(marks);
}

/* Half of the year exactly, the earlier of equals: also where most of it is dark. */
static void test_daylight_hours(void **state)
{
    double *light = calloc(8784, sizeof *light);
    unsigned char *marks = malloc(8784);
    (void)state;
    assert_true(light && marks);
    for (uint32_t i = 0; i < 8784; i++)
        light[i] = fmax(0, sin(i * 6.283185307179586 / 24)) + 1e-9 * i;
    assert_int_equal(orl_annual_daylight_mark(light, &leap, marks, NULL), 0);
    assert_int_equal(count_marks(marks, 8784), 4392);
    memset(light, 0, 8784 * sizeof *light);
    light[8000] = 1;
    assert_int_equal(orl_annual_daylight_mark(light, &hourly, marks, NULL), 0);
    assert_int_equal(count_marks(marks, 8760), 4380);
    assert_true(marks[8000] && marks[0] && marks[4378] && !marks[4379]);
    free(light);
    free(marks);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

/* A year whose days have so many lit hours from 6:00 on. */
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
    assert_int_equal(orl_annual_daylight_mark(light, steps, marks, NULL), 0);
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
    const struct orl_annual_light light = {row, row, NULL, NULL, NULL};
    struct orl_annual_value value;
    orl_annual_evaluate(&metric, &year->periods[ORL_WHEN_OCCUPIED], &light, &value);
    assert_true(isnan(value.low) && isnan(value.high));
    return value.value;
}

/* Every occupied hour at one value: what is met exactly counts, but for more than. */
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

/* Hours without a column count, as dark ones; the parts of UDI make up the whole. */
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

/* The share of one sensor with so many hours at a value: 0 or 100 %. */
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
        ORL_OVER_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50};
    const struct orl_annual_figure ase = {
        ORL_OVER_SHARE, {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0}, 250};
    const struct orl_annual_figure provision = {
        ORL_OVER_SHARE, {ORL_METRIC_DA, ORL_WHEN_DAYLIGHT, 300, 0}, 50};
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

/* ---- Errors ---------------------------------------------------------------------------------- */

static double draw_normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

enum { COLUMNS = 60 };

/* Sixty steps, all of which count, and twenty more that are dark. */
static struct orl_annual_period short_period(uint32_t columns[COLUMNS])
{
    for (uint32_t i = 0; i < COLUMNS; i++)
        columns[i] = i;
    return (struct orl_annual_period){columns, COLUMNS, 1, COLUMNS + 20};
}

/* Of every kind that grows: at its crossing the bound is met, a hair before it is not. */
static void test_crossings(void **state)
{
    static const struct {
        struct orl_annual_metric metric;
        double bound;
    } cases[] = {{{ORL_METRIC_DA, 0, 300, 0}, 40},          {{ORL_METRIC_CDA, 0, 500, 0}, 55},
                 {{ORL_METRIC_UDI_UPPER, 0, 600, 0}, 20},   {{ORL_METRIC_MEAN, 0, 0, 0}, 350},
                 {{ORL_METRIC_CUMULATIVE, 0, 0, 0}, 30000}, {{ORL_METRIC_HOURS, 0, 400, 0}, 25},
                 {{ORL_METRIC_DIRECT_HOURS, 0, 400, 0}, 25}};
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 0);
    float values[COLUMNS], errors[COLUMNS];
    double scratch[COLUMNS];
    uint32_t columns[COLUMNS];
    const struct orl_annual_period period = short_period(columns);
    const struct orl_annual_light light = {values, values, errors, errors, NULL},
                                  exact = {values, values, NULL, NULL, NULL};
    (void)state;
    for (int repeat = 0; repeat < 50; repeat++) {
        for (int i = 0; i < COLUMNS; i++) {
            values[i] = (float)(900 * orl_random_uniform(&random));
            errors[i] = i % 7 ? (float)(60 * orl_random_uniform(&random)) : 0;
        }
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            const struct orl_annual_metric *m = &cases[i].metric;
            const double bound = cases[i].bound, hair = 1e-6;
            const double z = orl_annual_crossing(m, bound, &period, &light, scratch);
            assert_true(isfinite(z) && orl_annual_grows(m->kind));
            assert_true(orl_annual_at(m, &period, &light, z + hair) >= bound - 1e-9 * bound);
            assert_true(orl_annual_at(m, &period, &light, z - hair) < bound);
            const double bare = orl_annual_crossing(m, bound, &period, &exact, scratch);
            assert_true(isinf(bare));
            assert_int_equal(bare < 0, z <= 0);
        }
    }
}

/* Met exactly, with an error: at least passes, more than does not. */
static void test_crossings_at_zero(void **state)
{
    float value = 1000, error = 10;
    double scratch[1];
    uint32_t column = 0;
    const struct orl_annual_period period = {&column, 1, 1, 1};
    const struct orl_annual_light light = {&value, &value, &error, &error, NULL};
    const struct orl_annual_metric at_least = {ORL_METRIC_HOURS, 0, 1000, 0};
    const struct orl_annual_metric above = {ORL_METRIC_DIRECT_HOURS, 0, 1000, 0};
    (void)state;
    assert_true(orl_annual_crossing(&at_least, 1, &period, &light, scratch) <= 0);
    assert_true(orl_annual_crossing(&above, 1, &period, &light, scratch) > 0);
    assert_true(isinf(orl_annual_crossing(&above, 2, &period, &light, scratch)));
}

/* Student's t of 15 degrees, from tables: 5, 2.5 and 0.5 % are above. */
static void test_students_t(void **state)
{
    (void)state;
    assert_near(orl_student_t(0.05), 1.753, 5e-4);
    assert_near(orl_student_t(0.025), 2.131, 5e-4);
    assert_near(orl_student_t(0.005), 2.947, 5e-4);
    assert_near(orl_student_above(0), 0.5, 1e-15);
    assert_near(orl_student_above(-2.131), 0.975, 1e-4);
    assert_near(orl_student_above(INFINITY), 0, 1e-15);
}

/* Ten coins: P(< 2) = 11 / 1024, P(< 3) = 56 / 1024. Areas of 1 and 2 that differ. */
static void test_shares_of_coins(void **state)
{
    double crossing[12] = {0}, areas[12];
    struct orl_annual_area area;
    (void)state;
    assert_int_equal(orl_annual_share(crossing, NULL, 10, true, &area, NULL), 0);
    assert_near(area.value.value, 100, 1e-12);
    assert_near(area.value.low, 20, 1e-12);
    assert_near(area.value.high, 100, 1e-12); /* the value itself is never left out */
    assert_int_equal(area.open, 10);
    for (int i = 0; i < 10; i++)
        crossing[i] = 1e-300;
    assert_int_equal(orl_annual_share(crossing, NULL, 10, true, &area, NULL), 0);
    assert_near(area.value.value, 0, 0);
    assert_near(area.value.high, 80, 1e-12);
    crossing[10] = -INFINITY;
    crossing[11] = INFINITY;
    for (int i = 0; i < 12; i++)
        areas[i] = i < 10 ? 1 : 20;
    assert_int_equal(orl_annual_share(crossing, areas, 12, true, &area, NULL), 0);
    assert_near(area.value.low, 40, 1e-12); /* 20 of 50, which is the value */
    assert_near(area.value.high, 56, 1e-12);
    assert_int_equal(orl_annual_share(crossing, areas, 12, false, &area, NULL), 0);
    assert_near(area.value.value, 40, 1e-12);
    assert_true(isnan(area.value.low) && isnan(area.value.high));
}

/* Areas that differ, against sums of all 2^12 outcomes; the grid of 2^14 places rounds to 1e-4. */
static void test_shares_of_unequal_areas(void **state)
{
    enum { N = 12 };
    struct orl_random random = orl_random_stream(9, ORL_PURPOSE_BENCH, 1);
    struct orl_area_part parts[N];
    double low, high, total = 0, below = 0, above = 0;
    (void)state;
    for (int i = 0; i < N; i++) {
        parts[i] = (struct orl_area_part){0.5 + orl_random_uniform(&random),
                                          0.1 + 0.8 * orl_random_uniform(&random)};
        total += parts[i].area;
    }
    assert_int_equal(orl_chance_bounds(parts, N, 0.025, &low, &high), 0);
    for (unsigned outcome = 0; outcome < 1U << N; outcome++) {
        double sum = 0, chance = 1;
        for (int i = 0; i < N; i++) {
            sum += outcome >> i & 1 ? parts[i].area : 0;
            chance *= outcome >> i & 1 ? parts[i].pass : 1 - parts[i].pass;
        }
        below += sum < low - 1e-3 * total ? chance : 0;
        above += sum > high + 1e-3 * total ? chance : 0;
    }
    assert_true(below <= 0.025 && above <= 0.025);
    /* And they are no wider than they must be: 1 % of the area further in, more is outside. */
    double inside = 0;
    for (unsigned outcome = 0; outcome < 1U << N; outcome++) {
        double sum = 0, chance = 1;
        for (int i = 0; i < N; i++) {
            sum += outcome >> i & 1 ? parts[i].area : 0;
            chance *= outcome >> i & 1 ? parts[i].pass : 1 - parts[i].pass;
        }
        inside += sum >= low + 0.01 * total && sum <= high - 0.01 * total ? chance : 0;
    }
    assert_true(inside < 0.95);
}

/*
 * How often a sensor's interval holds the truth, its error being of one factor (so much of it) and
 * of each hour's own. Of one factor alone it is to be 95 %, or more since DA is a number of hours;
 * of less it is to be no less. Of 400 repeats, 3.5 standard deviations of a binomial: 3.8 %.
 */
static void check_coverage(const struct orl_annual_metric *metric, double common, uint64_t seed)
{
    enum { REPEATS = 400 };
    float truth[COLUMNS], seen[COLUMNS], errors[COLUMNS];
    uint32_t columns[COLUMNS];
    const struct orl_annual_period period = short_period(columns);
    int held = 0;
    for (uint64_t repeat = 0; repeat < REPEATS; repeat++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, repeat);
        const double factor = draw_normal(&random);
        struct orl_annual_value wanted, got;
        for (int i = 0; i < COLUMNS; i++) {
            truth[i] = (float)(100 * exp(3 * orl_random_uniform(&random)));
            errors[i] = 0.06F * truth[i];
            seen[i] = (float)(truth[i] + errors[i] * (sqrt(common) * factor +
                                                      sqrt(1 - common) * draw_normal(&random)));
        }
        const struct orl_annual_light right = {truth, NULL, NULL, NULL, NULL};
        const struct orl_annual_light measured = {seen, NULL, errors, NULL, NULL};
        orl_annual_evaluate(metric, &period, &right, &wanted);
        orl_annual_evaluate(metric, &period, &measured, &got);
        held += got.low - 1e-9 <= wanted.value && wanted.value <= got.high + 1e-9;
    }
    if (held < 0.912 * REPEATS)
        fail_msg("kind %d, common %g: %d of %d intervals hold", metric->kind, common, held,
                 REPEATS);
}

static void test_intervals_of_sensors(void **state)
{
    static const struct orl_annual_metric metrics[] = {{ORL_METRIC_DA, 0, 300, 0},
                                                       {ORL_METRIC_CDA, 0, 500, 0},
                                                       {ORL_METRIC_UDI, 0, 200, 1000},
                                                       {ORL_METRIC_MEAN, 0, 0, 0}};
    static const double common[] = {1, 0.7, 0.3};
    (void)state;
    for (size_t i = 0; i < sizeof metrics / sizeof *metrics; i++)
        for (size_t k = 0; k < sizeof common / sizeof *common; k++)
            check_coverage(&metrics[i], common[k], 100 * i + k);
}

/* A room whose sensors get less light the deeper they lie: the shares' intervals. */
enum { SENSORS = 150 };
struct room {
    float truth[SENSORS * COLUMNS], seen[SENSORS * COLUMNS], errors[SENSORS * COLUMNS];
};

static void look(struct room *room, double common, struct orl_random *random)
{
    for (int s = 0; s < SENSORS; s++) {
        const double factor = draw_normal(random);
        for (int i = 0; i < COLUMNS; i++) {
            const int at = s * COLUMNS + i;
            room->errors[at] = 0.08F * room->truth[at];
            room->seen[at] = (float)(room->truth[at] +
                                     room->errors[at] * (sqrt(common) * factor +
                                                         sqrt(1 - common) * draw_normal(random)));
        }
    }
}

static void test_intervals_of_shares(void **state)
{
    enum { REPEATS = 400 };
    static const double common[] = {1, 0.6};
    struct room *room = malloc(sizeof *room);
    uint32_t columns[COLUMNS];
    struct orl_annual_period periods[ORL_WHEN_COUNT];
    const struct orl_annual_figure figure = {
        ORL_OVER_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50};
    struct orl_annual_area wanted, got;
    (void)state;
    assert_non_null(room);
    periods[ORL_WHEN_OCCUPIED] = short_period(columns);
    for (int s = 0; s < SENSORS; s++)
        for (int i = 0; i < COLUMNS; i++)
            room->truth[s * COLUMNS + i] =
                (float)(1500 * exp(-2.5 * s / SENSORS) * (0.2 + 1.2 * i / COLUMNS));
    const struct orl_annual_rows right = {
        .total_lx = room->truth, .n_sensors = SENSORS, .n_columns = COLUMNS};
    const struct orl_annual_rows measured = {.total_lx = room->seen,
                                             .total_error_lx = room->errors,
                                             .n_sensors = SENSORS,
                                             .n_columns = COLUMNS};
    assert_int_equal(orl_annual_figure_of(&figure, periods, &right, &wanted, NULL), 0);
    for (int c = 0; c < 2; c++) {
        int held = 0;
        for (uint64_t repeat = 0; repeat < REPEATS; repeat++) {
            struct orl_random random =
                orl_random_stream(31 + (uint64_t)c, ORL_PURPOSE_BENCH, repeat);
            look(room, common[c], &random);
            assert_int_equal(orl_annual_figure_of(&figure, periods, &measured, &got, NULL), 0);
            assert_true(got.open > 0 && got.open < SENSORS / 2);
            held += got.value.low <= wanted.value.value && wanted.value.value <= got.value.high;
        }
        if (held < 0.912 * REPEATS)
            fail_msg("common %g: %d of %d hold", common[c], held, REPEATS);
    }
    free(room);
}

/* ---- Areas ----------------------------------------------------------------------------------- */

static struct orl_annual_value figure_over(enum orl_annual_over over,
                                           const struct orl_annual_rows *rows)
{
    uint32_t columns[2] = {0, 1};
    struct orl_annual_period periods[ORL_WHEN_COUNT] = {[ORL_WHEN_OCCUPIED] = {columns, 2, 1, 2}};
    const struct orl_annual_figure figure = {over, {ORL_METRIC_MEAN, ORL_WHEN_OCCUPIED, 0, 0}, 150};
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
    struct orl_annual_value value = figure_over(ORL_OVER_AVERAGE, &rows);
    (void)state;
    assert_near(value.value, 250, 1e-9);
    assert_near(value.high - value.value, hypot(up, up_3) / 4, 1e-6);
    assert_near(value.value - value.low, hypot(down, down_3) / 4, 1e-6);
    value = figure_over(ORL_OVER_OF_MEAN, &rows);
    assert_near(value.value, 250, 1e-5);
    assert_near(value.high, 250 * exp(t * both / 250), 1e-4);
    value = figure_over(ORL_OVER_LEAST, &rows);
    assert_near(value.value, 100, 1e-9);
    assert_near(value.high, 100 * exp(t * 0.03), 1e-6);
    assert_near(orl_student_above(-log(value.low / 100) / 0.03), 1 - sqrt(0.975), 1e-9);
    value = figure_over(ORL_OVER_SHARE, &rows);
    assert_near(value.value, 75, 1e-9);
    assert_near(value.low, 75, 1e-9);
}

static void test_refused_figures(void **state)
{
    const float total[1] = {1};
    const struct orl_annual_rows rows = {.total_lx = total, .n_sensors = 1, .n_columns = 1};
    const struct orl_annual_rows none = {.total_lx = total, .n_columns = 1};
    const struct orl_annual_period periods[ORL_WHEN_COUNT] = {{0}};
    const struct orl_annual_figure udi = {ORL_OVER_SHARE, {ORL_METRIC_UDI, 0, 100, 3000}, 50};
    const struct orl_annual_figure ase = {ORL_OVER_SHARE, {ORL_METRIC_DIRECT_HOURS, 0, 1, 0}, 50};
    const struct orl_annual_figure da = {ORL_OVER_SHARE, {ORL_METRIC_DA, 0, 1, 0}, 50};
    struct orl_annual_area area;
    (void)state;
    assert_int_equal(orl_annual_figure_of(&udi, periods, &rows, &area, NULL), ORL_ERR_INVALID);
    assert_int_equal(orl_annual_figure_of(&ase, periods, &rows, &area, NULL), ORL_ERR_INVALID);
    assert_int_equal(orl_annual_figure_of(&da, periods, &none, &area, NULL), ORL_ERR_INVALID);
}

/* ---- Targets --------------------------------------------------------------------------------- */

static struct orl_annual_target parse(const char *text)
{
    struct orl_annual_target target;
    struct orl_error err = {0};
    if (orl_annual_target_parse(text, &target, &err))
        fail_msg("%s: %s", text, err.message);
    return target;
}

static void assert_figure(const char *text, enum orl_annual_over over, enum orl_metric_kind kind,
                          enum orl_annual_when when, double low, double high, double least)
{
    const struct orl_annual_target target = parse(text);
    const struct orl_annual_figure *f = &target.figure;
    if (f->over != over || f->metric.kind != kind || f->metric.when != when ||
        f->metric.low_lx != low || f->metric.high_lx != high || f->least != least)
        fail_msg("%s is read as over %d, kind %d, when %d, %g %g, %g", text, f->over,
                 f->metric.kind, f->metric.when, f->metric.low_lx, f->metric.high_lx, f->least);
}

static void test_targets(void **state)
{
    const enum orl_annual_when used = ORL_WHEN_OCCUPIED;
    struct orl_annual_target target = parse("  SDA 300 , 50% of North office >55%");
    (void)state;
    assert_string_equal(target.grid, "North office");
    assert_true(target.relation == ORL_MORE_THAN && target.bound == 55);
    target = parse("ase1000,250 <= 10");
    assert_true(target.relation == ORL_AT_MOST && target.bound == 10 && !target.grid[0]);
    assert_figure("sDA >= 55 %", ORL_OVER_SHARE, ORL_METRIC_DA, used, 300, 0, 50);
    assert_figure("sDA150/50>=30%", ORL_OVER_SHARE, ORL_METRIC_DA, used, 150, 0, 50);
    assert_figure("sDA500/50 in daylight hours >= 50 %", ORL_OVER_SHARE, ORL_METRIC_DA,
                  ORL_WHEN_DAYLIGHT, 500, 0, 50);
    assert_figure("ASE < 10 %", ORL_OVER_SHARE, ORL_METRIC_DIRECT_HOURS, used, 1000, 0, 250);
    assert_figure("ASE1000/250h < 10 %", ORL_OVER_SHARE, ORL_METRIC_DIRECT_HOURS, used, 1000, 0,
                  250);
    assert_figure("DA500 >= 60 %", ORL_OVER_AVERAGE, ORL_METRIC_DA, used, 500, 0, 0);
    assert_figure("least da100 >= 50", ORL_OVER_LEAST, ORL_METRIC_DA, used, 100, 0, 0);
    assert_figure("cDA >= 60 %", ORL_OVER_AVERAGE, ORL_METRIC_CDA, used, 300, 0, 0);
    assert_figure("UDI100-3000 over the year >= 50 %", ORL_OVER_AVERAGE, ORL_METRIC_UDI,
                  ORL_WHEN_ALWAYS, 100, 3000, 0);
    assert_figure("UDI_lower100 <= 5 %", ORL_OVER_AVERAGE, ORL_METRIC_UDI_LOWER, used, 100, 0, 0);
    assert_figure("UDI_upper < 5 %", ORL_OVER_AVERAGE, ORL_METRIC_UDI_UPPER, used, 3000, 0, 0);
    assert_figure("illuminance >= 300 lx", ORL_OVER_AVERAGE, ORL_METRIC_MEAN, used, 0, 0, 0);
    assert_figure("hours300 of mean >= 2000 h", ORL_OVER_OF_MEAN, ORL_METRIC_HOURS, ORL_WHEN_ALWAYS,
                  300, 0, 0);
    assert_figure("least hours90 >= 2000 h", ORL_OVER_LEAST, ORL_METRIC_HOURS, ORL_WHEN_ALWAYS, 90,
                  0, 0);
}

static void test_targets_refused(void **state)
{
    static const char *const texts[] = {"",
                                        "DGP < 0.35",
                                        "sDA300/50",
                                        "sDA300/50 = 55 %",
                                        "sDA300/50 >= ",
                                        "sDA300/50 >= lots",
                                        "sDA300/50 >= 55 lx",
                                        "sDA300/50 >= 55 % of office",
                                        "sDA300/50 >= 101 %",
                                        "sDA300/50 >= 0.55",
                                        "sDA300/ >= 55 %",
                                        "sDA300/101 >= 55 %",
                                        "sDA0/50 >= 55 %",
                                        "UDI3000-100 >= 5 %",
                                        "least sDA >= 5 %",
                                        "least DA of mean >= 5 %",
                                        "sDA of >= 5 %",
                                        "illuminance >= 300 %",
                                        "sDAx300 >= 5 %"};
    struct orl_annual_target target = {.bound = -1};
    char long_text[200];
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct orl_error err = {0};
        if (orl_annual_target_parse(texts[i], &target, &err) == 0)
            fail_msg("'%s' is taken", texts[i]);
        assert_true(err.message[0] && (texts[i][0] == '\0' || strstr(err.message, texts[i])));
        assert_near(target.bound, -1, 0);
    }
    memset(long_text, ' ', sizeof long_text);
    memcpy(long_text + sizeof long_text - 12, "sDA >= 55 %", 12);
    assert_int_equal(orl_annual_target_parse(long_text, &target, NULL), ORL_ERR_LIMIT);
}

static enum orl_verdict judge(const char *text, double low, double high)
{
    const struct orl_annual_target target = parse(text);
    const struct orl_annual_value value = {(low + high) / 2, low, high};
    return orl_annual_judge(&target, &value);
}

static void test_verdicts(void **state)
{
    const double third = 100 * (11.0 / 20); /* 55 but for rounding */
    (void)state;
    assert_int_equal(judge("sDA >= 55 %", 55, 60), ORL_VERDICT_PASS);
    assert_int_equal(judge("sDA >= 55 %", third, third), ORL_VERDICT_PASS);
    assert_int_equal(judge("sDA > 55 %", third, third), ORL_VERDICT_FAIL);
    assert_int_equal(judge("sDA > 55 %", 55, 60), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("sDA >= 55 %", 50, 55), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("sDA >= 55 %", 50, 54.9), ORL_VERDICT_FAIL);
    assert_int_equal(judge("ASE <= 10 %", 5, 10), ORL_VERDICT_PASS);
    assert_int_equal(judge("ASE < 10 %", 5, 10), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("ASE <= 10 %", 11, 12), ORL_VERDICT_FAIL);
    assert_int_equal(judge("ASE <= 10 %", NAN, NAN), ORL_VERDICT_UNKNOWN);
    const struct orl_annual_target target = parse("sDA >= 55 %");
    const struct orl_annual_value wide = {55, 54, 56}, narrow = {55, 54.6, 55.4},
                                  far = {70, 60, 80};
    assert_false(orl_annual_settled(&target, &wide, 0.5));
    assert_true(orl_annual_settled(&target, &narrow, 0.5));
    assert_true(orl_annual_settled(&target, &far, 0.5));
    assert_int_equal(orl_verdict_both(ORL_VERDICT_PASS, ORL_VERDICT_PASS), ORL_VERDICT_PASS);
    assert_int_equal(orl_verdict_both(ORL_VERDICT_PASS, ORL_VERDICT_UNDECIDED),
                     ORL_VERDICT_UNDECIDED);
    assert_int_equal(orl_verdict_both(ORL_VERDICT_UNKNOWN, ORL_VERDICT_FAIL), ORL_VERDICT_FAIL);
}

/* All targets of all rules can be read, and names find those they begin. */
static void test_rules(void **state)
{
    static const struct {
        const char *name;
        size_t count;
    } names[] = {{"en 17037", 3},       {"EN 17037 medium", 1}, {"LEED", 4},
                 {"WELL L01", 2},       {"WELL L06", 4},        {"BREEAM offices", 1},
                 {"BREEAM", 9},         {"roof lights", 3},     {"LEED v4.1, 2 points", 1},
                 {"WELL L06 tier 2", 2}};
    const struct orl_annual_rule *rules;
    size_t count, all = 0;
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(orl_annual_rules_find(names[i].name, &rules, &count, NULL), 0);
        assert_int_equal(count, names[i].count);
        for (size_t k = 0; k < count; k++)
            for (int t = 0; t < ORL_RULE_TARGETS && rules[k].targets[t]; t++, all++)
                parse(rules[k].targets[t]);
    }
    assert_true(all > 20);
    assert_int_equal(orl_annual_rules_find("DIN 5034", &rules, &count, NULL), ORL_ERR_NOT_FOUND);
    assert_int_equal(orl_annual_rules_find("", &rules, &count, NULL), ORL_ERR_NOT_FOUND);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_years),
        cmocka_unit_test(test_occupancy_by_the_clock),
        cmocka_unit_test(test_occupancy_files),
        cmocka_unit_test(test_marked_occupancy_file),
        cmocka_unit_test(test_daylight_hours),
        cmocka_unit_test(test_thresholds_met_exactly),
        cmocka_unit_test(test_nights_count),
        cmocka_unit_test(test_hours_met_exactly),
        cmocka_unit_test(test_crossings),
        cmocka_unit_test(test_crossings_at_zero),
        cmocka_unit_test(test_students_t),
        cmocka_unit_test(test_shares_of_coins),
        cmocka_unit_test(test_shares_of_unequal_areas),
        cmocka_unit_test(test_intervals_of_sensors),
        cmocka_unit_test(test_intervals_of_shares),
        cmocka_unit_test(test_averages_and_the_worst),
        cmocka_unit_test(test_refused_figures),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_targets_refused),
        cmocka_unit_test(test_verdicts),
        cmocka_unit_test(test_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
