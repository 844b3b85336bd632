/*
 * Stated errors of sensors, by every photon map technique: they equal the scatter from seed to
 * seed; intervals hold the truth as often as they should; all are equal for any number of threads.
 * (The office and other scenes: `make calibration`.)
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/room.h"

enum { SENSORS = 6, TECHNIQUES = 3 };
static const enum orl_technique techniques[TECHNIQUES] = {
    ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_PRECOMPUTED, ORL_TECHNIQUE_DIRECT};

/* On the wall of a sphere of radius 1 with a lamp of radius 0.1 in the middle. */
static const struct orl_sensor on_sphere[SENSORS] = {
    {{0, 0, -1}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, -1}}, {{1, 0, 0}, {-1, 0, 0}},
    {{-1, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {0, -1, 0}}, {{0, -1, 0}, {0, 1, 0}}};

static struct orl_result run_sphere(enum orl_technique technique, uint64_t seed, uint32_t threads)
{
    return scene_run(&(struct scene_run){.scene = "void light l 0 0 3 100 100 100\n"
                                                  "l sphere lamp 0 0 4 0 0 0 .1\n" ROOM_GREY
                                                  "w bubble wall 0 0 4 0 0 0 1\n",
                                         .sensors = on_sphere,
                                         .n_sensors = SENSORS,
                                         .technique = technique,
                                         .seed = seed,
                                         .global = 20000,
                                         .samples = 2048,
                                         .threads = threads});
}

static uint64_t count_seeds(void)
{
    return extent(15, 30);
}

/* Sums over seeds and over all sensors, which have one true value. */
struct told {
    double seen, told; /* relative variances about the truth */
    int covered;
};

static struct told run_seeds(enum orl_technique technique, double truth)
{
    struct told t = {0, 0, 0};
    const double values = (double)(SENSORS * count_seeds());
    for (uint64_t seed = 1; seed <= count_seeds(); seed++) {
        struct orl_result r = run_sphere(technique, seed, 1);
        for (size_t i = 0; i < SENSORS; i++) {
            const double off = r.illuminance_lx[i] / truth - 1;
            const double se = r.standard_error_lx[i] / truth;
            t.seen += off * off / values;
            t.told += se * se / values;
            t.covered += r.interval_95_lx[i][0] <= truth && truth <= r.interval_95_lx[i][1];
        }
        orl_result_done(&r);
    }
    return t;
}

/*
 * pi L a^2 of direct light, and the rest by a geometric series. There are six nearly independent
 * values per seed. A variance of n of them has a relative error of sqrt(2 / n); stated ones of 3 to
 * 15 degrees of freedom sqrt(2 / (3 n)) at worst. The logarithm of their ratio is allowed four
 * times both together: 0.48 of 180 values, 0.69 of 90. Bias is within that: at most a tenth of the
 * scatter here. Intervals cover 95 of 100, with a binomial scatter: four times that below is
 * allowed.
 */
static void test_sphere(void **state)
{
    const double rho = 0.5, a = 0.1, n = (double)(SENSORS * count_seeds());
    const double truth = ORL_EFFICACY_LM_PER_W * ORL_PI * 100 * a * a / (1 - rho * (1 - a * a));
    (void)state;
    for (int i = 0; i < TECHNIQUES; i++) {
        const struct told t = run_seeds(techniques[i], truth);
        print_message("%s: scatter %.4f, told %.4f, covered %d of %.0f\n",
                      orl_technique_name(techniques[i]), sqrt(t.seen), sqrt(t.told), t.covered, n);
        assert_true(fabs(log(t.seen / t.told)) < 4 * sqrt(2 / n + 2 / (3 * n)));
        assert_true(t.covered > 0.95 * n - 4 * sqrt(n * 0.95 * 0.05));
    }
}

/* The bytes of errors are equal for any number of threads. */
static void test_threads(void **state)
{
    (void)state;
    for (int i = 0; i < TECHNIQUES; i++) {
        struct orl_result one = run_sphere(techniques[i], 7, 1);
        struct orl_result three = run_sphere(techniques[i], 7, 3);
        const size_t size = SENSORS * sizeof(double);
        assert_memory_equal(one.standard_error_lx, three.standard_error_lx, size);
        assert_memory_equal(one.bias_estimate_lx, three.bias_estimate_lx, size);
        assert_memory_equal(one.interval_95_lx, three.interval_95_lx, 2 * size);
        orl_result_done(&one);
        orl_result_done(&three);
    }
}

/* Two seeds are independent: they share no ray at any sensor. */
static void test_seeds_differ(void **state)
{
    struct orl_result r[2];
    (void)state;
    for (uint64_t seed = 1; seed <= 2; seed++)
        r[seed - 1] = run_sphere(ORL_TECHNIQUE_GATHER, seed, 1);
    for (size_t i = 0; i < SENSORS; i++)
        for (size_t k = 0; k < SENSORS; k++)
            assert_true(r[0].illuminance_lx[i] != r[1].illuminance_lx[k]);
    orl_result_done(&r[0]);
    orl_result_done(&r[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_seeds_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
