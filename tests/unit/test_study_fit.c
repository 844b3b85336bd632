/* The fit of error by photons and samples, non-negative least squares, and the Pareto front. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"
#include "study/study_errors.h"
#include "support/study_data.h"

static const uint64_t photons[] = {10000, 40000, 160000, 640000};
static const uint32_t samples[] = {64, 256, 1024, 4096};
enum { GRID = 16, DRAWS = 60 };

/* Terms each of which dominates somewhere on the grid above. */
static const struct study_grid grid = {.technique = ORL_TECHNIQUE_GATHER,
                                       .photons = photons,
                                       .n_photons = 4,
                                       .samples = samples,
                                       .n_samples = 4,
                                       .terms = {1e-4, 20, 1e6, 0.4}};

static void test_exact_data_give_the_parameters_back(void **state)
{
    struct orl_study_point points[GRID];
    struct orl_study_fit fit;
    (void)state;
    study_grid_points(&grid, points);
    assert_int_equal(orl_study_fit_make(points, GRID, ORL_TECHNIQUE_GATHER, &fit, NULL), 1);
    assert_int_equal(fit.points, GRID);
    /* The normal equations of columns scaled to one have a condition below 1e4 here: with the
     * 1e-16 of doubles, 1e-12 remains, plus a margin. */
    for (int t = 0; t < ORL_FIT_TERMS; t++)
        assert_true(fabs(fit.terms[t] / grid.terms[t] - 1) < 1e-9);
    assert_true(fit.residual < 1e-9 && fit.chi2 < 1e-9);
    for (int i = 0; i < GRID; i++)
        assert_true(fabs(orl_study_fit_predict(&fit, &points[i].setting) / points[i].rms - 1) <
                    1e-9);
}

/*
 * Data with noise, in DRAWS repetitions. Each estimate's deviation over the standard deviation
 * that the fit reports is about a standard normal. Over DRAWS repetitions the mean of its square
 * is 1, with a standard deviation of sqrt(2 / DRAWS) = 0.18. The bound is 4 of these, and 0.3 for
 * non-normality: uncertainties of the data are at least 10 %, and the fitted values are of
 * log-normal data, cut off at zero. The mean deviation is 0, with a standard deviation of 1 /
 * sqrt(DRAWS) = 0.13; the bound is 4 of these.
 */
static void test_noisy_data_give_the_parameters_within_their_errors(void **state)
{
    double sum[ORL_FIT_TERMS] = {0}, squares[ORL_FIT_TERMS] = {0}, chi2 = 0;
    (void)state;
    for (uint64_t draw = 0; draw < DRAWS; draw++) {
        struct study_grid noisy = grid;
        struct orl_study_point points[GRID];
        struct orl_study_fit fit;
        noisy.spread = 0.12;
        noisy.index = draw;
        study_grid_points(&noisy, points);
        assert_int_equal(orl_study_fit_make(points, GRID, ORL_TECHNIQUE_GATHER, &fit, NULL), 1);
        chi2 += fit.chi2 / DRAWS;
        for (int t = 0; t < ORL_FIT_TERMS; t++) {
            const double z = (fit.terms[t] - grid.terms[t]) / fit.errors[t];
            assert_true(fit.terms[t] >= 0 && fit.errors[t] > 0);
            sum[t] += z / DRAWS;
            squares[t] += z * z / DRAWS;
        }
    }
    for (int t = 0; t < ORL_FIT_TERMS; t++) {
        print_message("%s: mean %.2f, mean square %.2f\n", orl_fit_term_name((enum orl_fit_term)t),
                      sum[t], squares[t]);
        assert_true(fabs(sum[t]) < 4 * 0.13);
        assert_true(fabs(squares[t] - 1) < 4 * 0.18 + 0.3);
    }
    /* 12 degrees of freedom: the mean of DRAWS has a standard deviation of sqrt(2 / 12 / DRAWS). */
    assert_true(fabs(chi2 - 1) < 4 * sqrt(2.0 / 12 / DRAWS));
}

static void test_what_settings_cannot_tell_is_absent(void **state)
{
    static const struct {
        size_t n_photons, n_samples;
        bool there[ORL_FIT_TERMS];
    } cases[] = {
        {1, 4, {true, false, false, true}},
        {2, 4, {true, true, false, true}},
        {4, 1, {true, true, true, false}},
        {2, 1, {true, true, false, false}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct study_grid some = grid;
        struct orl_study_point points[GRID];
        struct orl_study_fit fit;
        some.n_photons = cases[i].n_photons;
        some.n_samples = cases[i].n_samples;
        study_grid_points(&some, points);
        const size_t n = some.n_photons * some.n_samples;
        assert_int_equal(orl_study_fit_make(points, n, ORL_TECHNIQUE_GATHER, &fit, NULL), 1);
        for (int t = 0; t < ORL_FIT_TERMS; t++)
            assert_int_equal(isfinite(fit.terms[t]), cases[i].there[t]);
        /* Points of one technique do not count for another, and one point is too few. */
        assert_int_equal(orl_study_fit_make(points, n, ORL_TECHNIQUE_DIRECT, &fit, NULL), 0);
        assert_int_equal(orl_study_fit_make(points, 1, ORL_TECHNIQUE_GATHER, &fit, NULL), 0);
    }
}

/* Small problems against a search over all sets of columns held at zero, by the conditions of Kuhn
 * and Tucker: no descent along a column at zero, none in either direction along the others. */
static void test_least_squares_meet_their_conditions(void **state)
{
    enum { ROWS = 7, COLUMNS = 4, PROBLEMS = 500 };
    size_t zeros = 0;
    (void)state;
    for (uint64_t problem = 0; problem < PROBLEMS; problem++) {
        struct orl_random random = orl_random_stream(3, ORL_PURPOSE_REFIT, problem);
        double a[ROWS * COLUMNS], b[ROWS], x[COLUMNS];
        for (int i = 0; i < ROWS * COLUMNS; i++)
            a[i] = orl_random_uniform(&random) - 0.3;
        for (int i = 0; i < ROWS; i++)
            b[i] = orl_random_uniform(&random) - 0.3;
        orl_nnls(a, b, ROWS, COLUMNS, x);
        for (int c = 0; c < COLUMNS; c++) {
            double descent = 0;
            for (int i = 0; i < ROWS; i++) {
                double rest = b[i];
                for (int k = 0; k < COLUMNS; k++)
                    rest -= a[i * COLUMNS + k] * x[k];
                descent += a[i * COLUMNS + c] * rest;
            }
            assert_true(x[c] >= 0);
            assert_true(x[c] > 0 ? fabs(descent) < 1e-9 : descent < 1e-9);
            zeros += x[c] > 0 ? 0 : 1;
        }
    }
    assert_true(zeros > PROBLEMS / 4 && zeros < PROBLEMS * (COLUMNS - 1));
}

static void test_dependent_columns_do_no_harm(void **state)
{
    const double a[] = {1, 2, 0, 1, 2, 0, 1, 2, 1}, b[] = {4, 4, 5};
    double x[3];
    (void)state;
    orl_nnls(a, b, 3, 3, x);
    /* (4, 4, 5) = 4 u + v, for any division of the 4 between the first two columns, u and 2 u. */
    assert_true(fabs(x[0] + 2 * x[1] - 4) < 1e-9 && fabs(x[2] - 1) < 1e-9);
}

static void test_front_is_what_nothing_beats(void **state)
{
    /* Time, rms; of two equal points the first is on the front. */
    static const double data[][2] = {{1, 5},   {2, 3}, {3, 4},     {4, 3},  {5, 1},
                                     {0.5, 9}, {5, 1}, {0.4, NAN}, {6, 0.5}};
    static const bool wanted[] = {true, true, false, false, true, true, false, false, true};
    struct orl_study_point points[sizeof wanted] = {0};
    (void)state;
    for (size_t i = 0; i < sizeof wanted; i++) {
        points[i].total_s = data[i][0];
        points[i].rms = data[i][1];
    }
    orl_study_mark_front(points, sizeof wanted);
    for (size_t i = 0; i < sizeof wanted; i++)
        assert_int_equal(points[i].on_front, wanted[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_data_give_the_parameters_back),
        cmocka_unit_test(test_noisy_data_give_the_parameters_within_their_errors),
        cmocka_unit_test(test_what_settings_cannot_tell_is_absent),
        cmocka_unit_test(test_least_squares_meet_their_conditions),
        cmocka_unit_test(test_dependent_columns_do_no_harm),
        cmocka_unit_test(test_front_is_what_nothing_beats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
