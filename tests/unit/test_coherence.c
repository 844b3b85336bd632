/* Coherence of errors with known results, and the intervals derived from it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "annual/coefficients/apply_weather.h"
#include "metrics/annual/annual_figures.h"

enum { HOURS = 16, TILES = 2 };

static void assert_near(double value, double wanted, double within)
{
    if (!(fabs(value - wanted) <= within))
        fail_msg("%.9g, not %.9g", value, wanted);
}

/* Hours with 200 lx, each with a standard error of 1 %; half of the sums is in each of two tiles.
 * Other error sources are 0. */
static struct orl_error_sums sums[TILES * ORL_ERROR_BANDS];
static float total[HOURS], interpolation_error[HOURS];
static uint32_t columns[HOURS], node[HOURS];
static const struct orl_sun_cells cells = {columns, node, HOURS};

static struct orl_error_sums *band_of(size_t tile)
{
    return &sums[tile * ORL_ERROR_BANDS + (size_t)orl_error_band(200)];
}

static void reset_sums(void)
{
    memset(sums, 0, sizeof sums);
    for (uint32_t i = 0; i < HOURS; i++) {
        total[i] = 200;
        interpolation_error[i] = 0;
        columns[i] = i;
        node[i] = i / 4;
    }
    for (size_t tile = 0; tile < TILES; tile++)
        band_of(tile)->errors = 0.01 * HOURS / TILES;
}

static double found(void)
{
    return (double)orl_coherence_of(sums, TILES, 1, total, interpolation_error, &cells);
}

/* Batches that deviate equally in all hours give a coherence of 1; so do photon batches. */
static void test_common_errors(void **state)
{
    (void)state;
    reset_sums();
    for (size_t tile = 0; tile < TILES; tile++)
        for (int b = 0; b < ORL_ANNUAL_BATCHES; b++)
            band_of(tile)->batches[b] =
                (float)(0.01 * sqrt(ORL_ANNUAL_BATCHES - 1.0) * (b % 2 ? 1 : -1) * HOURS / TILES);
    assert_near(found(), 1, 1e-6);
    reset_sums();
    for (size_t tile = 0; tile < TILES; tile++)
        for (int photon_batch = 0; photon_batch < ORL_SUN_PHOTON_BATCHES; photon_batch++)
            band_of(tile)->photon_batches[photon_batch] =
                (float)(0.01 * sqrt(ORL_SUN_PHOTON_BATCHES - 1.0) * (photon_batch % 2 ? 1 : -1) *
                        HOURS / TILES);
    assert_near(found(), 1, 1e-6);
}

/* Batches whose deviations cancel between two tiles give none. */
static void test_errors_that_cancel(void **state)
{
    (void)state;
    reset_sums();
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        band_of(0)->batches[b] = b % 2 ? 1 : -1;
        band_of(1)->batches[b] = b % 2 ? -1 : 1;
    }
    assert_near(found(), 0, 1e-6);
}

/* The sum of n independent errors has sqrt(n) times the error of one. Errors between the same
 * nodes are one error: here four cells of four hours. Bands of illuminance are summed one by one.
 */
static void test_independent_errors(void **state)
{
    (void)state;
    reset_sums();
    for (size_t tile = 0; tile < TILES; tile++)
        band_of(tile)->squares = 0.01 * 0.01 * HOURS / TILES;
    assert_near(found(), 1 / sqrt(HOURS), 1e-6);
    reset_sums();
    for (int i = 0; i < HOURS; i++)
        interpolation_error[i] = 0.01F;
    assert_near(found(), 1 / sqrt(4), 1e-6);
    for (int i = 0; i < HOURS; i++)
        total[i] = i < 8 ? 200 : 2000;
    for (size_t tile = 0; tile < TILES; tile++) {
        band_of(tile)->errors /= 2;
        sums[tile * ORL_ERROR_BANDS + (size_t)orl_error_band(2000)].errors = band_of(tile)->errors;
    }
    assert_near(found(), 1 / sqrt(2), 1e-6);
    memset(sums, 0, sizeof sums);
    assert_near(found(), 0, 0);
}

/* A year of two hours at 200 lx, one with sun: the coherence scales the errors of that hour, in
 * intervals, with precomputed factors, and at thresholds. */
static void test_intervals(void **state)
{
    const float lx[] = {200, 200}, errors[] = {20, 20}, coherence = 0.5F;
    const unsigned char sunny[] = {1, 0};
    uint32_t both[] = {0, 1}, first[] = {0};
    const struct orl_annual_metric mean = {ORL_METRIC_MEAN, 0, 0, 0},
                                   da = {ORL_METRIC_DA, 0, 210, 0};
    const struct orl_annual_period year = {both, 2, 1, 2}, hour = {first, 1, 1, 1};
    struct orl_annual_light light = {
        .total_lx = lx, .total_error_lx = errors, .coherence = &coherence, .sunny = sunny};
    struct orl_annual_value plain, ready;
    float factors[2];
    double scratch[2];
    (void)state;
    orl_annual_evaluate(&mean, &year, &light, &plain);
    assert_near(plain.high, 100 * (exp(0.05 * ORL_ANNUAL_Z) + exp(0.1 * ORL_ANNUAL_Z)), 1e-4);
    orl_annual_error_factors(&light, 2, factors);
    light.total_factor = factors;
    orl_annual_evaluate(&mean, &year, &light, &ready);
    assert_near(ready.high, plain.high, 1e-4);
    assert_near(ready.low, plain.low, 1e-4);
    assert_near(orl_annual_crossing(&da, 100, &hour, &light, scratch), log(1.05) / 0.05, 1e-6);
    light.coherence = NULL;
    assert_near(orl_annual_crossing(&da, 100, &hour, &light, scratch), log(1.05) / 0.1, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_common_errors), cmocka_unit_test(test_errors_that_cancel),
        cmocka_unit_test(test_independent_errors), cmocka_unit_test(test_intervals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
