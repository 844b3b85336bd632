/* Pooled results of rounds; the error bound for a share of sensors; the schedule of rounds and its
 * cost. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "run/estimate/round_cost.h"
#include "run/goals/pooled_results.h"
#include "run/run_state.h"

/* Returns a standard normal number, by Box and Muller. */
static double normal(struct orl_random *random)
{
    const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(u)) * cos(2 * ORL_PI * v);
}

static void assert_near(double value, double expected, double relative)
{
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.10g is not %.10g", value, expected);
}

static struct orl_random numbers(uint64_t index)
{
    return orl_random_stream(5, ORL_PURPOSE_BENCH, index);
}

/* ---- Pools ----------------------------------------------------------------------------------- */

static void test_weighted_means(void **state)
{
    static const double first[2] = {1, 10}, second[2] = {5, 10}, errors[2][2] = {{3, 1}, {1, 1}};
    static const double biases[2][2] = {{2, 0}, {1, 0}};
    struct orl_pooled_estimates pooled;
    double ret[2];
    (void)state;
    assert_int_equal(orl_pooled_init(&pooled, 2, 0, NULL), 0);
    assert_false(orl_pooled_errors(&pooled, 0, ret));
    orl_pooled_add(&pooled, &(struct orl_round_values){first, errors[0], biases[0], 15, 1, NULL});
    assert_true(orl_pooled_errors(&pooled, 0, ret));
    assert_near(ret[0], 3, 1e-15);
    orl_pooled_add(&pooled, &(struct orl_round_values){second, errors[1], biases[1], 15, 3, NULL});
    assert_near(pooled.mean[0], 4, 1e-15);
    assert_near(pooled.bias[0], 1.25, 1e-15);
    assert_true(orl_pooled_errors(&pooled, 0, ret));
    assert_near(ret[0], sqrt(1 * 9 + 9 * 1) / 4, 1e-15);
    assert_near(ret[1], sqrt(1 * 1 + 9 * 1) / 4, 1e-15);
    /* Welch: (1 + 3)^2 / (1 / 15 + 9 / 15). */
    assert_near(orl_pooled_degrees(&pooled), 16 * 15 / 10.0, 1e-15);
    orl_pooled_done(&pooled);
}

/* Three batches over two rounds: means, and the error of their mean, by hand. */
static void test_groups_that_go_on(void **state)
{
    static const double values[2] = {2, 6}, errors[2] = {9, 9};
    static const double batches[2][3] = {{1, 2, 3}, {9, 6, 3}};
    struct orl_pooled_estimates pooled;
    double ret;
    (void)state;
    assert_int_equal(orl_pooled_init(&pooled, 1, 3, NULL), 0);
    assert_false(orl_pooled_errors(&pooled, 0, &ret));
    for (int r = 0; r < 2; r++)
        orl_pooled_add(&pooled, &(struct orl_round_values){.value = &values[r],
                                                           .error = &errors[r],
                                                           .degrees_of_freedom = 2,
                                                           .weight = 1 + 2 * r,
                                                           .batches = batches[r]});
    assert_near(pooled.mean[0], 5, 1e-15);
    assert_true(orl_pooled_errors(&pooled, 0, &ret));
    assert_near(ret, sqrt((4 + 0 + 4) / 3.0 / 2), 1e-15); /* sums of 7, 5 and 3 */
    assert_near(orl_pooled_degrees(&pooled), 2, 1e-15);
    orl_pooled_done(&pooled);
}

enum { VALUES = 4000 };

/* Fills in rounds of normal errors with variance 1 / weight; the reported variance is `factor`
 * times that. */
static void fill_pooled(struct orl_pooled_estimates *pooled, const double *weights, int rounds,
                        double factor)
{
    double *value = malloc(VALUES * sizeof *value), *error = malloc(VALUES * sizeof *error);
    assert_true(value && error && orl_pooled_init(pooled, VALUES, 0, NULL) == 0);
    for (int r = 0; r < rounds; r++) {
        struct orl_random random = numbers((uint64_t)r);
        for (int i = 0; i < VALUES; i++) {
            const double deviation = (1 + i % 4) / sqrt(weights[r]);
            value[i] = 100 * (1 + i % 4) + deviation * normal(&random);
            error[i] = factor * deviation;
        }
        orl_pooled_add(pooled, &(struct orl_round_values){value, factor > 0 ? error : NULL, NULL,
                                                          15, weights[r], NULL});
    }
    free(value);
    free(error);
}

/* Returns the mean of (reported error / true error)^2. */
static double ratio(const struct orl_pooled_estimates *pooled)
{
    double *errors = malloc(VALUES * sizeof *errors), sum = 0;
    assert_true(orl_pooled_errors(pooled, 1e-3, errors));
    for (int i = 0; i < VALUES; i++)
        sum += errors[i] * errors[i] * pooled->weight / ((1 + i % 4) * (1 + i % 4)) / VALUES;
    free(errors);
    return sum;
}

/*
 * Errors from the spread alone, with two rounds: 4000 variances of one degree of freedom each have
 * a mean that scatters by sqrt(2 / 4000) = 2.2 %; the bound is three times that. Pooled over
 * sensors, single errors are within the factor 3 that 4 degrees of freedom allow.
 */
static void test_errors_from_the_spread(void **state)
{
    static const double weights[2] = {1, 7};
    struct orl_pooled_estimates pooled;
    double errors[VALUES];
    (void)state;
    fill_pooled(&pooled, weights, 2, 0);
    assert_near(ratio(&pooled), 1, 0.067);
    assert_near(orl_pooled_degrees(&pooled), 5, 1e-15);
    orl_pooled_errors(&pooled, 1e-3, errors);
    for (int i = 0; i < VALUES; i++)
        assert_true(errors[i] > 0.85 * (1 + i % 4) / sqrt(8));
    orl_pooled_done(&pooled);
}

/* If rounds report too small errors, the pool corrects them. The dispersion of 3 x 4000 squares
 * scatters by sqrt(2 / 12000) = 1.3 %; bounds are three times that. */
static void test_rounds_that_tell_too_little(void **state)
{
    static const double weights[4] = {1, 2, 4, 2};
    struct orl_pooled_estimates honest, boastful;
    (void)state;
    fill_pooled(&honest, weights, 4, 1);
    assert_near(orl_pooled_dispersion(&honest), 1, 0.04);
    assert_near(ratio(&honest), 1, 1e-12);
    fill_pooled(&boastful, weights, 4, 0.5);
    assert_near(orl_pooled_dispersion(&boastful), 4, 0.04);
    assert_near(ratio(&boastful), 1, 0.04);
    orl_pooled_done(&honest);
    orl_pooled_done(&boastful);
}

/* ---- Percentiles ----------------------------------------------------------------------------- */

enum { SENSORS = 57 };

/* Returns the probability of at most `allowed` successes in n trials: the binomial distribution. */
static double at_most(int n, int allowed, double p)
{
    double sum = 0;
    for (int k = 0; k <= allowed; k++)
        sum += exp(lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1) + k * log(p) +
                   (n - k) * log1p(-p));
    return sum;
}

enum { MANY = 400 };

/* n equal normal errors: returns the probability that one exceeds the estimated bound, over the
 * allowed probability by the binomial distribution. */
static double likelihood_at_bound(int n, int allowed, double *ret_bound)
{
    double value[MANY], error[MANY], low = 1e-9, high = 1 - 1e-9;
    for (int i = 0; i < n; i++) {
        value[i] = 50;
        error[i] = 1;
    }
    const struct orl_estimates estimates = {
        .value = value, .error = error, .count = (size_t)n, .floor = 1e-3};
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        *(at_most(n, allowed, middle) > 0.975 ? &low : &high) = middle;
    }
    *ret_bound = orl_percentile_error(&estimates, 0.95);
    assert_near(orl_percentile_work(&estimates, 0.95, *ret_bound / 2), 4, 1e-9);
    assert_near(orl_percentile_work(&estimates, 0.95, 2 * *ret_bound), 1, 1e-15);
    return erfc(*ret_bound * 50 / sqrt(2)) / low;
}

/* Exact if few may exceed the bound. For 20 of 400, Cornish and Fisher's expansion leaves 1 % of
 * x, 5 % of p. */
static void test_even_errors(void **state)
{
    double ten, all, many;
    (void)state;
    assert_near(likelihood_at_bound(10, 0, &ten), 1, 1e-4);
    assert_near(likelihood_at_bound(SENSORS, 2, &all), 1, 1e-4);
    assert_near(likelihood_at_bound(MANY, 20, &many), 1, 0.05);
    assert_true(many < all && all < ten);
}

/*
 * Unequal errors, sampled 20000 times: the share of samples whose 55th error of 57 is within the
 * bound is 0.975. It scatters by 0.0011, and three times that are allowed.
 */
static void test_uneven_errors_and_biases(void **state)
{
    double value[SENSORS], error[SENSORS], bias[SENSORS];
    struct orl_random random = numbers(99);
    int within = 0;
    (void)state;
    for (int i = 0; i < SENSORS; i++) {
        value[i] = 100;
        error[i] = 1 + 0.1 * i;
        bias[i] = i % 3 - 1;
    }
    const struct orl_estimates estimates = {
        .value = value, .error = error, .bias = bias, .count = SENSORS, .floor = 1e-3};
    const double x = 100 * orl_percentile_error(&estimates, 0.95);
    for (int draw = 0; draw < 20000; draw++) {
        int beyond = 0;
        for (int i = 0; i < SENSORS; i++)
            beyond += fabs(bias[i] + error[i] * normal(&random)) > x;
        within += beyond <= 2;
    }
    assert_near(within / 20000.0, 0.975, 0.0033);
    /* Half the error takes more than four times the work if some of it is bias. */
    assert_true(orl_percentile_work(&estimates, 0.95, x / 200) > 4);
}

/*
 * Errors that are estimates of 15 degrees of freedom each: the bound holds in 0.975 of samples of
 * both. With 6000 samples that scatters by 0.0020, and three times that are allowed. Below, 0.01
 * more are allowed, because the unbiased quantity is a probability, not the bound that solves for
 * it. If such errors are taken for exact, the bound holds in 0.987 of these samples, which is too
 * much.
 */
static void test_errors_that_scatter(void **state)
{
    enum { DRAWS = 6000, DEGREES = 15 };
    double value[SENSORS], error[SENSORS];
    const struct orl_estimates estimates = {.value = value,
                                            .error = error,
                                            .count = SENSORS,
                                            .floor = 1e-3,
                                            .degrees_of_freedom = DEGREES};
    struct orl_random random = numbers(98);
    int within = 0;
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        value[i] = 100;
    for (int draw = 0; draw < DRAWS; draw++) {
        int beyond = 0;
        for (int i = 0; i < SENSORS; i++) {
            double squares = 0;
            for (int k = 0; k < DEGREES; k++) {
                const double x = normal(&random);
                squares += x * x / DEGREES;
            }
            error[i] = sqrt(squares);
        }
        const double x = 100 * orl_percentile_error(&estimates, 0.95);
        for (int i = 0; i < SENSORS; i++)
            beyond += fabs(normal(&random)) > x;
        within += beyond <= 2;
    }
    assert_true(within > (0.975 - 0.006 - 0.01) * DRAWS && within < (0.975 + 0.006) * DRAWS);
}

static void test_what_is_not_known_and_dark(void **state)
{
    double value[4] = {100, 100, 100, 0}, error[4] = {1, 1, 1, 0.2};
    struct orl_estimates estimates = {.value = value, .error = error, .count = 4, .floor = 1e-3};
    (void)state;
    /* The dark sensor is divided by 0.1 % of 75: its error exceeds its share. */
    assert_true(orl_percentile_error(&estimates, 1) > 1);
    assert_true(orl_percentile_error(&estimates, 0.75) < 0.05);
    error[0] = NAN;
    assert_true(isnan(orl_percentile_error(&estimates, 0.95)));
    for (int i = 0; i < 4; i++)
        value[i] = error[i] = 0;
    assert_true(orl_percentile_error(&estimates, 0.95) == 0);
}

/* ---- Schedules ------------------------------------------------------------------------------- */

static void test_schedule(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_GATHER, .photons = {2000000, 0}, .least = 256, .most = 16384};
    (void)state;
    assert_true(orl_work_next(&work, 0, 0) == 256);
    assert_true(orl_work_next(&work, 256, 300) == 256);   /* the least */
    assert_true(orl_work_next(&work, 256, 1000) == 768);  /* 1.02 x 1000 - 256, of 16 */
    assert_true(orl_work_next(&work, 256, 1e6) == 2048);  /* 8 x 256 */
    assert_true(orl_work_next(&work, 1e5, 1e9) == 16384); /* the most */
    assert_true(orl_work_photons(&work, ORL_MAP_GLOBAL, 4096) == 2000000);
    assert_true(orl_work_photons(&work, ORL_MAP_GLOBAL, 8192) == 4000000);
    assert_true(orl_work_photons(&work, ORL_MAP_CAUSTIC, 4096) == 0);
}

/* Returns the number of lamps for 4096 samples in rounds of that many sensors; the planner chose
 * 57000. */
static uint64_t lamps_for(size_t sensors, enum orl_technique technique, size_t views)
{
    const struct orl_job job = {.n_views = views};
    struct orl_result result = {.plan = {.technique = technique, .photons_global = 57000}};
    const struct orl_run_state state = {.job = &job, .result = &result, .n_sensors = sensors};
    const struct orl_work work = orl_work_of(&state);
    return orl_work_photons(&work, ORL_MAP_GLOBAL, 4096);
}

/* Lamps are reduced in proportion to the sensors they light, down to a quarter; only lamps are. */
static void test_lamps_of_few_sensors(void **state)
{
    (void)state;
    assert_int_equal(lamps_for(200, ORL_TECHNIQUE_BACKWARD, 0), 57000);
    assert_int_equal(lamps_for(57, ORL_TECHNIQUE_BACKWARD, 0), 57000);
    assert_int_equal(lamps_for(19, ORL_TECHNIQUE_BACKWARD, 0), 19000);
    assert_int_equal(lamps_for(1, ORL_TECHNIQUE_BACKWARD, 0), 14250);
    assert_int_equal(lamps_for(19, ORL_TECHNIQUE_BACKWARD, 1), 57000);
    assert_int_equal(lamps_for(19, ORL_TECHNIQUE_GATHER, 0), 57000);
}

/* Kernels of equal rounds: the number of all photons to the power -1/3; with one large round, 2/3
 * of its own. */
static void test_bandwidths(void **state)
{
    double first[ORL_MAP_KINDS], eighth[ORL_MAP_KINDS], large[ORL_MAP_KINDS];
    (void)state;
    orl_work_bandwidths(4096, 0, first);
    orl_work_bandwidths(4096, 7 * 4096, eighth);
    orl_work_bandwidths(8 * 4096, 0, large);
    assert_near(first[ORL_MAP_CAUSTIC], 1, 1e-12);
    assert_near(first[ORL_MAP_GLOBAL], 1, 1e-12);
    assert_near(eighth[ORL_MAP_CAUSTIC], 0.5, 1e-12);
    assert_near(eighth[ORL_MAP_GLOBAL], 0.5, 1e-12);
    assert_near(large[ORL_MAP_CAUSTIC], 4, 1e-12);
}

/* Seconds of a schedule in full: rounds of 256, 2048 and the remainder of 1.02 x 4000, 1776. */
static void test_seconds(void **state)
{
    const struct orl_work work = {
        .technique = ORL_TECHNIQUE_GATHER, .photons = {4096, 4096}, .least = 256, .most = 16384};
    const struct orl_throughput throughput = {.setup_s = 2,
                                              .photons = 1000,
                                              .photon_s = 1, /* 1 ms each, two a sample */
                                              .samples = 500,
                                              .render_s = 1, /* 2 ms each */
                                              .rounds = 2,
                                              .other_s = 1};
    (void)state;
    assert_near(orl_throughput_round_s(&throughput, &work, 256), 0.5 + 0.004 * 256, 1e-12);
    assert_near(orl_throughput_run_s(&throughput, &work, 4000),
                2 + 3 * 0.5 + 0.004 * (256 + 2048 + 1776), 1e-12);
    assert_near(orl_throughput_samples(&throughput, &work, 4.5, 1e9), 1000, 0.016);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weighted_means),
        cmocka_unit_test(test_groups_that_go_on),
        cmocka_unit_test(test_errors_from_the_spread),
        cmocka_unit_test(test_rounds_that_tell_too_little),
        cmocka_unit_test(test_even_errors),
        cmocka_unit_test(test_uneven_errors_and_biases),
        cmocka_unit_test(test_errors_that_scatter),
        cmocka_unit_test(test_what_is_not_known_and_dark),
        cmocka_unit_test(test_schedule),
        cmocka_unit_test(test_lamps_of_few_sensors),
        cmocka_unit_test(test_bandwidths),
        cmocka_unit_test(test_seconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
