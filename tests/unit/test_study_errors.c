/* Error measures against a reference, on synthetic numbers with known answers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"
#include "study/study_errors.h"

enum { MANY = 40000, RUNS = 4 };

static double draw_normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(2 * ORL_PI * v);
}

/* Worked out by hand: two sensors, two seeds, a reference without error. */
static void test_small_numbers(void **state)
{
    double truth[] = {100, 200}, first[] = {110, 200}, second[] = {110, 180}, errors[] = {0, 0};
    double *reference_runs[] = {truth}, *runs[] = {first, second};
    struct orl_reference reference;
    struct orl_study_point p = {0};
    (void)state;
    assert_int_equal(orl_reference_make(&reference, reference_runs, 1, errors, 2, false, NULL), 0);
    assert_int_equal(orl_study_compute_errors(&reference, runs, 2, false, &p, NULL), 0);
    /* e: 0.1, 0 and 0.1, -0.1. */
    assert_float_equal(p.rms, sqrt(0.03 / 4), 1e-12);
    assert_float_equal(p.bias, 0.1 / 4, 1e-12);
    /* Between seeds: none at the first, 0.1^2 / 2 at the second. */
    assert_float_equal(p.noise, sqrt(0.0025), 1e-12);
    assert_float_equal(p.p95, 0.1, 1e-12);
    assert_true(isnan(p.peak) && !p.reference_shows);
    orl_reference_done(&reference);
}

/*
 * Values with known bias and noise, against a reference with a known error: the measures return
 * the bias and noise, without the reference's share. rms^2 is a mean over MANY values of e^2 with
 * e of variance v = bias^2 + noise^2 + own^2. Its standard deviation is below sqrt(3 / MANY) v,
 * because the reference's part is the same in every run. Bounds are 4 of these; likewise for the
 * bias, whose standard deviation is sqrt(v / MANY).
 */
static void test_the_references_own_error_is_taken_out(void **state)
{
    const double bias = 0.02, noise = 0.03, own = 0.04, v = 0.0029;
    double *values = calloc((RUNS + 2) * MANY, sizeof *values), *runs[RUNS];
    double *reference_values = values, *errors = values + MANY;
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_REFIT, 1);
    struct orl_reference reference;
    struct orl_study_point p = {0};
    struct orl_study_reference about = {0};
    (void)state;
    assert_non_null(values);
    for (size_t k = 0; k < MANY; k++) {
        reference_values[k] = 500 * (1 + own * draw_normal(&random));
        errors[k] = 500 * own;
    }
    for (int i = 0; i < RUNS; i++) {
        runs[i] = values + (size_t)(i + 2) * MANY;
        for (size_t k = 0; k < MANY; k++)
            runs[i][k] = 500 * (1 + bias + noise * draw_normal(&random));
    }
    /* Given as pixels, because sensors with no better reference are left out. */
    assert_int_equal(orl_reference_make(&reference, &reference_values, 1, errors, MANY, true, NULL),
                     0);
    orl_reference_describe(&reference, &about);
    assert_int_equal(about.values, MANY);
    assert_int_equal(orl_study_compute_errors(&reference, runs, RUNS, true, &p, NULL), 0);
    /* Dividing by the reference instead of the truth adds terms of the order of own^2 = 0.0016,
     * relative to each measure; to the bias, own^2 itself. */
    assert_true(fabs(about.standard_error / own - 1) < 0.01);
    assert_true(fabs(p.rms * p.rms - bias * bias - noise * noise) <
                4 * sqrt(3.0 / MANY) * v + 6e-5);
    assert_true(fabs(p.bias - bias - own * own) < 4 * sqrt(v / MANY));
    assert_true(fabs(p.noise / noise - 1) < 4 * sqrt(0.5 / MANY) + 0.005);
    assert_true(p.reference_shows);
    orl_reference_done(&reference);
    free(values);
}

static void test_badly_known_and_dark_sensors_are_left_out(void **state)
{
    double truth[] = {100, 100, 0}, errors[] = {0.9, 1.1, 0}, run[] = {101, 300, 0};
    double *reference_runs[] = {truth}, *runs[] = {run};
    struct orl_reference reference;
    struct orl_study_point p = {0};
    struct orl_study_reference about = {0};
    (void)state;
    assert_int_equal(orl_reference_make(&reference, reference_runs, 1, errors, 3, false, NULL), 0);
    orl_reference_describe(&reference, &about);
    /* The dark sensor stays: its scale is 0.1 % of the mean, and its value is right. */
    assert_int_equal(about.values, 2);
    assert_int_equal(about.left_out, 1);
    assert_float_equal(about.worst, 0.009, 1e-12);
    assert_int_equal(orl_study_compute_errors(&reference, runs, 1, false, &p, NULL), 0);
    assert_float_equal(p.bias, 0.005, 1e-12);
    assert_true(isnan(p.noise) && isnan(p.rms_error));
    orl_reference_done(&reference);
    double dark[] = {0, 0, 0};
    double *dark_runs[] = {dark};
    assert_int_equal(orl_reference_make(&reference, dark_runs, 1, NULL, 3, false, NULL),
                     ORL_ERR_INVALID);
}

/* Runs of 1 and 3 about 2: mean 2, standard error 1. The brightest two of 200 pixels determine the
 * peak, for any error of the others. */
static void test_views_know_their_error_by_runs_and_their_peaks(void **state)
{
    enum { PIXELS = 200 };
    double a[PIXELS], b[PIXELS], run[PIXELS], *reference_runs[] = {a, b}, *runs[] = {run};
    struct orl_reference reference;
    struct orl_study_point p = {0};
    (void)state;
    for (int i = 0; i < PIXELS; i++) {
        a[i] = i < 2 ? 1000 : 1;
        b[i] = i < 2 ? 1000 : 3;
        run[i] = i == 0 ? 1100 : i == 1 ? 950 : 50;
    }
    assert_int_equal(orl_reference_make(&reference, reference_runs, 2, NULL, PIXELS, true, NULL),
                     0);
    assert_float_equal(reference.value[5], 2, 1e-12);
    assert_float_equal(reference.error[5], 1, 1e-12);
    assert_int_equal(orl_study_compute_errors(&reference, runs, 1, true, &p, NULL), 0);
    assert_float_equal(p.peak, 0.1, 1e-12);
    orl_reference_done(&reference);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_small_numbers),
        cmocka_unit_test(test_the_references_own_error_is_taken_out),
        cmocka_unit_test(test_badly_known_and_dark_sensors_are_left_out),
        cmocka_unit_test(test_views_know_their_error_by_runs_and_their_peaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
