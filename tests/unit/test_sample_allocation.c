/* Allocation of samples to sensors by their noise, and the work that it saves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"
#include "run/goals/percentile.h"

enum { SENSORS = 60 };

/* One sensor in twelve is five times as noisy as the others; all have 64 samples. */
struct sensors {
    double value[SENSORS], error[SENSORS], noise[SENSORS];
};

static struct orl_estimates make_sensors(struct sensors *s, double of_one)
{
    for (int i = 0; i < SENSORS; i++) {
        const double relative = of_one * (i % 12 == 0 ? 5 : 1);
        s->value[i] = 100.0 * (1 + i % 3);
        s->noise[i] = s->value[i] * s->value[i] * relative * relative;
        s->error[i] = sqrt(s->noise[i] / 64);
    }
    return (struct orl_estimates){.value = s->value,
                                  .error = s->error,
                                  .noise = s->noise,
                                  .samples = 64,
                                  .count = SENSORS,
                                  .floor = 1e-3};
}

/* Allocation by relative deviation: 5 against 1, the mean 4 / 3, and a fifth of all uniformly. */
static void test_shares(void **state)
{
    const double noisy = 0.2 + 0.8 * 5 * 3 / 4, quiet = 0.2 + 0.8 * 3 / 4;
    struct sensors sensors;
    double samples[SENSORS], sum = 0;
    (void)state;
    const struct orl_estimates estimates = make_sensors(&sensors, 0.1);
    orl_allocate_samples(&estimates, 1000, samples);
    for (int i = 0; i < SENSORS; i++) {
        const double expected = 1000 * (i % 12 == 0 ? noisy : quiet);
        assert_true(fabs(samples[i] - expected) < 1e-9 * expected);
        sum += samples[i];
    }
    assert_true(fabs(sum - 1000 * SENSORS) < 1e-6);
}

/*
 * The predicted work for a target, checked by the resulting errors. A uniform round of 64 samples
 * each and an allocated one, weighted by their mean numbers of samples, have the bound at the
 * target. The work is less than 0.7 of that with uniform samples (16.9 against 25 times the
 * first).
 */
static void test_work(void **state)
{
    struct sensors sensors, then;
    (void)state;
    const struct orl_estimates estimates = make_sensors(&sensors, 0.1);
    const double target = orl_percentile_error(&estimates, 0.95) / 5;
    const double work = orl_allocation_work(&estimates, 0.95, target), more = 64 * (work - 1);
    struct orl_estimates later = make_sensors(&then, 0.1);
    for (int i = 0; i < SENSORS; i++) {
        const double share = 0.2 + 0.8 * (i % 12 == 0 ? 5 : 1) * 3 / 4;
        const double left = sensors.error[i] / work,
                     added = sqrt(sensors.noise[i] / (more * share));
        then.error[i] = hypot(left, added * (1 - 1 / work));
    }
    later.samples = 64 * work;
    assert_true(fabs(orl_percentile_error(&later, 0.95) / target - 1) < 1e-3);
    assert_true(work < 0.7 * orl_percentile_work(&estimates, 0.95, target));
    assert_true(orl_allocation_work(&estimates, 0.95, 6 * target) == 1);
}

/* Returns a mean of long-tailed samples of mean 1: the exponential of a normal. */
static double group_mean(struct orl_random *random, double sigma, int samples)
{
    double sum = 0;
    for (int k = 0; k < samples; k++) {
        const double u = 1 - orl_random_uniform(random), v = orl_random_uniform(random);
        sum += exp(sigma * sqrt(-2 * log(u)) * cos(2 * ORL_PI * v) - 0.5 * sigma * sigma);
    }
    return sum / samples;
}

/* Returns a sensor's first round: the mean of 16 groups; their spread gives the error. */
static double first_round(struct orl_random *random, double sigma, double *ret_error)
{
    double mean = 0, squares = 0;
    for (int g = 0; g < 16; g++) {
        const double x = group_mean(random, sigma, 4);
        mean += x / 16;
        squares += x * x / 16;
    }
    *ret_error = sqrt((squares - mean * mean) / 15);
    return mean;
}

/*
 * The combination of two rounds is unbiased, with mean 1, for long-tailed samples: 100 runs of 60
 * sensors, where weights by sensor would have a bias of more than 1 %. The mean's own error is the
 * scatter of the runs.
 */
static void test_no_bias(void **state)
{
    enum { RUNS = 100, FIRST = 64, SECOND = 128 };
    const double sigma = 1;
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, 0);
    double sum = 0, squares = 0;
    (void)state;
    for (int run = 0; run < RUNS; run++) {
        struct sensors s;
        double samples[SENSORS], mean = 0;
        for (int i = 0; i < SENSORS; i++) {
            s.value[i] = first_round(&random, sigma, &s.error[i]);
            s.noise[i] = FIRST * s.error[i] * s.error[i];
        }
        const struct orl_estimates estimates = {.value = s.value,
                                                .error = s.error,
                                                .noise = s.noise,
                                                .samples = FIRST,
                                                .count = SENSORS,
                                                .floor = 1e-3};
        orl_allocate_samples(&estimates, SECOND, samples);
        for (int i = 0; i < SENSORS; i++) {
            const double second = group_mean(&random, sigma, (int)samples[i]);
            mean += (FIRST * s.value[i] + SECOND * second) / (FIRST + SECOND) / SENSORS;
        }
        sum += mean / RUNS;
        squares += mean * mean / RUNS;
    }
    const double error = sqrt((squares - sum * sum) / (RUNS - 1));
    assert_true(error < 0.003);
    if (fabs(sum - 1) > 3 * error)
        fail_msg("%.4f +- %.4f is not 1", sum, error);
}

/* Without light, or without noise, the allocation is uniform and saves nothing. */
static void test_nothing_to_share_out_by(void **state)
{
    struct sensors s;
    double samples[SENSORS];
    (void)state;
    struct orl_estimates estimates = make_sensors(&s, 0);
    orl_allocate_samples(&estimates, 48, samples);
    assert_true(samples[0] == 48 && samples[SENSORS - 1] == 48);
    assert_true(orl_allocation_work(&estimates, 0.95, 0.01) == 1);
    for (int i = 0; i < SENSORS; i++)
        s.value[i] = 0;
    orl_allocate_samples(&estimates, 48, samples);
    assert_true(samples[0] == 48);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shares),
        cmocka_unit_test(test_work),
        cmocka_unit_test(test_no_bias),
        cmocka_unit_test(test_nothing_to_share_out_by),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
