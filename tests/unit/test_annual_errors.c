/*
 * Errors of annual metrics: thresholds at which a sensor changes sides, shares of areas against
 * binomial tables, coverage of intervals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include <oriel/annual/annual_metrics.h>

#include "base/sampling/sampling.h"
#include "metrics/annual/annual_figures.h"
static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

/* ---- Errors ---------------------------------------------------------------------------------- */

static double draw_normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

enum { COLUMNS = 60 };

/* Sixty steps that all count, and twenty more that are dark. */
static struct orl_annual_period short_period(uint32_t columns[COLUMNS])
{
    for (uint32_t i = 0; i < COLUMNS; i++)
        columns[i] = i;
    return (struct orl_annual_period){columns, COLUMNS, 1, COLUMNS + 20};
}

/* Every increasing metric meets the bound at its crossing, and does not just below it. */
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
    const struct orl_annual_light light = {.total_lx = values,
                                           .direct_lx = values,
                                           .total_error_lx = errors,
                                           .direct_error_lx = errors},
                                  exact = {.total_lx = values, .direct_lx = values};
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
            assert_true(isfinite(z) && orl_annual_is_monotonic(m->kind));
            assert_true(orl_annual_evaluate_at(m, &period, &light, z + hair) >=
                        bound - 1e-9 * bound);
            assert_true(orl_annual_evaluate_at(m, &period, &light, z - hair) < bound);
            const double bare = orl_annual_crossing(m, bound, &period, &exact, scratch);
            assert_true(isinf(bare));
            assert_int_equal(bare < 0, z <= 0);
        }
    }
}

/* At exactly the bound, with an error: "at least" passes, "more than" does not. */
static void test_crossings_at_zero(void **state)
{
    float value = 1000, error = 10;
    double scratch[1];
    uint32_t column = 0;
    const struct orl_annual_period period = {&column, 1, 1, 1};
    const struct orl_annual_light light = {.total_lx = &value,
                                           .direct_lx = &value,
                                           .total_error_lx = &error,
                                           .direct_error_lx = &error};
    const struct orl_annual_metric at_least = {ORL_METRIC_HOURS, 0, 1000, 0};
    const struct orl_annual_metric above = {ORL_METRIC_DIRECT_HOURS, 0, 1000, 0};
    (void)state;
    assert_true(orl_annual_crossing(&at_least, 1, &period, &light, scratch) <= 0);
    assert_true(orl_annual_crossing(&above, 1, &period, &light, scratch) > 0);
    assert_true(isinf(orl_annual_crossing(&above, 2, &period, &light, scratch)));
}

/* Student's t of 15 degrees of freedom, from tables: upper tails of 5, 2.5 and 0.5 %. */
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

/* Ten sensors at the bound. The interval's ends assume each sensor 0.35 standard errors beyond the
 * bound, or before it: each then passes with probability 0.366, and P(< 1) = 0.010, P(< 2) =
 * 0.071. The areas differ: 1 and 2. */
static void test_shares_of_coins(void **state)
{
    double crossing[12] = {0}, areas[12];
    struct orl_annual_area area;
    (void)state;
    assert_int_equal(orl_annual_area_share(crossing, NULL, 10, true, NULL, &area, NULL), 0);
    assert_near(area.value.value, 100, 1e-12);
    assert_near(area.value.low, 10, 1e-12);
    assert_near(area.value.high, 100, 1e-12); /* the interval includes the value itself */
    assert_int_equal(area.open, 10);
    for (int i = 0; i < 10; i++)
        crossing[i] = 1e-300;
    assert_int_equal(orl_annual_area_share(crossing, NULL, 10, true, NULL, &area, NULL), 0);
    assert_near(area.value.value, 0, 0);
    assert_near(area.value.high, 90, 1e-12);
    crossing[10] = -INFINITY;
    crossing[11] = INFINITY;
    for (int i = 0; i < 12; i++)
        areas[i] = i < 10 ? 1 : 20;
    assert_int_equal(orl_annual_area_share(crossing, areas, 12, true, NULL, &area, NULL), 0);
    assert_near(area.value.low, 40, 1e-12); /* 20 of 50, which is the value */
    assert_near(area.value.high, 58, 1e-12);
    assert_int_equal(orl_annual_area_share(crossing, areas, 12, false, NULL, &area, NULL), 0);
    assert_near(area.value.value, 40, 1e-12);
    assert_true(isnan(area.value.low) && isnan(area.value.high));
}

/* Unequal areas, against sums over all 2^12 outcomes; the grid of 2^14 places rounds to 1e-4. */
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
    assert_int_equal(orl_passing_area_bounds(parts, N, 0.025, NULL, &low, &high), 0);
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
    /* The ends are tight: with 1 % more of the area outside, the probability exceeds the limit. */
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
 * Measures how often a sensor's interval contains the truth. `common` is the share of the error
 * common to all hours; the rest is independent per hour. With common errors only, coverage is 95
 * %, or more because DA is a number of hours; otherwise it is no less. Tolerance for 400 repeats,
 * 3.5 standard deviations of a binomial: 3.8 %.
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
        const struct orl_annual_light right = {.total_lx = truth};
        const struct orl_annual_light measured = {.total_lx = seen, .total_error_lx = errors};
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

/* A room whose sensors get less light the deeper they lie: intervals of the shares. */
enum { SENSORS = 150 };
struct room {
    float truth[SENSORS * COLUMNS], seen[SENSORS * COLUMNS], errors[SENSORS * COLUMNS];
};

static void simulate_measurement(struct room *room, double common, struct orl_random *random)
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
        ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50};
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
            simulate_measurement(room, common[c], &random);
            assert_int_equal(orl_annual_figure_of(&figure, periods, &measured, &got, NULL), 0);
            assert_true(got.open > 0 && got.open < SENSORS / 2);
            held += got.value.low <= wanted.value.value && wanted.value.value <= got.value.high;
        }
        if (held < 0.912 * REPEATS)
            fail_msg("common %g: %d of %d hold", common[c], held, REPEATS);
    }
    free(room);
}

/* A whole area is exactly 100 %, in spite of rounding, and n of 100 equal parts are n %. */
static void test_all_of_an_area(void **state)
{
    double crossing[300], areas[300];
    (void)state;
    for (size_t n = 1; n <= 300; n++) {
        struct orl_annual_area area;
        for (size_t i = 0; i < n; i++) {
            crossing[i] = -50;
            areas[i] = 0.1 * (double)(i % 7 + 1);
        }
        assert_int_equal(orl_annual_area_share(crossing, areas, n, true, NULL, &area, NULL), 0);
        assert_true(area.value.value == 100 && area.value.low == 100 && area.value.high == 100);
    }
    for (size_t n = 0; n <= 100; n++) {
        struct orl_annual_area area;
        for (size_t i = 0; i < 100; i++)
            crossing[i] = i < n ? -50 : 50;
        assert_int_equal(orl_annual_area_share(crossing, NULL, 100, true, NULL, &area, NULL), 0);
        assert_true(area.value.value == (double)n);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crossings),
        cmocka_unit_test(test_crossings_at_zero),
        cmocka_unit_test(test_students_t),
        cmocka_unit_test(test_shares_of_coins),
        cmocka_unit_test(test_shares_of_unequal_areas),
        cmocka_unit_test(test_intervals_of_sensors),
        cmocka_unit_test(test_intervals_of_shares),
        cmocka_unit_test(test_all_of_an_area),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
