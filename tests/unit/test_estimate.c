/*
 * Error estimates: intervals against tables of Student's t and against random samples; parts by
 * batch; the bias of a density from another area.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/sampling/sampling.h"
#include "base/statistics/estimate.h"
#include "photon/density/adaptive_density.h"
#include "photon/map/quantization.h"
#include "support/cli.h"

/* Without bias the interval is Student's t at 97.5 %, from tables. */
static void test_student(void **state)
{
    static const double table[][2] = {
        {3, 3.182}, {5, 2.571}, {15, 2.131}, {30, 2.042}, {1e9, 1.96}};
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const struct orl_estimate e = {.standard_error = 2, .degrees_of_freedom = table[i][0]};
        assert_true(fabs(orl_estimate_margins(&e).above / 2 / table[i][1] - 1) < 0.01);
    }
}

/*
 * For an estimate of known scatter and bias the interval covers the truth in 95 of 100 cases, for
 * any bias. 40000 samples: 0.95 +- 4 sqrt(0.95 0.05 / 40000) = 0.0044.
 */
static void test_biased(void **state)
{
    enum { DRAWS = 40000 };
    (void)state;
    for (double bias = 0; bias<5; bias = bias> 0 ? 2 * bias : 0.25) {
        const struct orl_estimate e = {
            .standard_error = 1, .degrees_of_freedom = 1e9, .bias = -bias};
        const double half = orl_estimate_margins(&e).below;
        struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, (uint64_t)(8 * bias));
        int covered = 0;
        for (int i = 0; i < DRAWS; i++) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            covered += fabs(sqrt(-2 * log(1 - u)) * cos(2 * ORL_PI * v) - bias) <= half;
        }
        assert_true(fabs(covered / (double)DRAWS - 0.95) < 0.0044);
    }
}

static double normal_draw(struct orl_random *random)
{
    const double u = orl_random_uniform(random), v = orl_random_uniform(random);
    return sqrt(-2 * log(1 - u)) * cos(2 * ORL_PI * v);
}

/* Counts how often intervals of the mean of 16 groups lie below the truth, with the skewness
 * correction and without. Groups are exp(sigma N), or N if sigma is 0. */
static void count_misses(double sigma, double *ret_misses, double *ret_even)
{
    enum { DRAWS = 20000, GROUPS = 16 };
    const double truth = sigma > 0 ? exp(0.5 * sigma * sigma) : 0;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, (uint64_t)(8 * sigma));
    *ret_misses = *ret_even = 0;
    for (int i = 0; i < DRAWS; i++) {
        struct orl_rgb groups[GROUPS];
        for (int k = 0; k < GROUPS; k++) {
            const double x = normal_draw(&random);
            groups[k] = orl_gray(sigma > 0 ? exp(sigma * x) : x);
        }
        const struct orl_estimate e = orl_estimate_of_mean(groups, GROUPS);
        const struct orl_margins margins = orl_estimate_margins(&e);
        *ret_misses += (truth > e.value.g + margins.above) / (double)DRAWS;
        *ret_even += (truth > e.value.g + margins.below) / (double)DRAWS;
    }
}

/*
 * Skewed estimates. For lognormal groups (sigma 1: skewness 6) symmetric intervals lie too low
 * eight times as often as the nominal 2.5 %. The skewness correction removes more than a third of
 * that. For normal groups it changes almost nothing. 20000 samples: a standard error of 0.25 % at
 * most.
 */
static void test_skewed(void **state)
{
    double misses, even;
    (void)state;
    count_misses(0, &misses, &even);
    assert_true(fabs(even - 0.025) < 0.0045 && even - misses < 0.005 && misses <= even);
    count_misses(1, &misses, &even);
    print_message("below the truth: %.3f of lognormal groups' intervals, %.3f even\n", misses,
                  even);
    assert_true(misses < 0.65 * even);
}

/* With bias only, the interval is as wide as the bias. In sums variances add, and degrees of
 * freedom are between those of the terms. */
static void test_sums(void **state)
{
    const struct orl_rgb values[2] = {{1, 1, 1}, {3, 3, 3}};
    const struct orl_estimate sure = {.degrees_of_freedom = 15, .bias = -0.5};
    const struct orl_estimate a = {
        .value = {1, 1, 1}, .standard_error = 3, .degrees_of_freedom = 15};
    const struct orl_estimate b = {
        .value = {2, 2, 2}, .standard_error = 4, .degrees_of_freedom = 3, .bias = 1};
    (void)state;
    assert_true(orl_estimate_margins(&sure).above == 0.5);
    const struct orl_estimate sum = orl_estimate_add(a, b);
    assert_true(fabs(sum.standard_error - 5) < 1e-12 && sum.value.g == 3 && sum.bias == 1);
    assert_true(fabs(sum.degrees_of_freedom - 625 / (81.0 / 15 + 256.0 / 3)) < 1e-9);
    const struct orl_estimate mean = orl_estimate_of_mean(values, 2);
    assert_true(mean.value.g == 2 && fabs(mean.standard_error - 1) < 1e-12 &&
                mean.degrees_of_freedom == 1);
}

/* Packed parts sum to the whole, each to half a 255th of the largest. */
static void test_packed_parts(void **state)
{
    struct orl_batches parts = {{0}};
    uint8_t shares[ORL_MAP_BATCHES];
    (void)state;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        parts.luma[i] = 3.0 * i;
    orl_batches_pack(&parts, shares);
    const struct orl_batches back = orl_batches_unpack(shares, 360);
    double sum = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++) {
        assert_true(fabs(back.luma[i] - parts.luma[i]) < 0.01 * 45);
        sum += back.luma[i];
    }
    assert_true(fabs(sum - 360) < 1e-9);
    orl_batches_pack(&(struct orl_batches){{0}}, shares);
    assert_true(orl_batches_variance(&(struct orl_batches){{0}}) == 0);
    assert_true(orl_batches_unpack(shares, 1).luma[3] == 0);
}

/* ---- Densities ------------------------------------------------------------------------------- */

static char folder[64];
static struct orl_search *search;
static const struct orl_vec3 up = {0, 0, 1};

static int set_up(void **state)
{
    (void)state;
    cli_make_folder(folder);
    search = calloc(1, sizeof *search);
    return sodium_init() < 0 || !search ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    free(search);
    cli_remove_folder(folder);
    return 0;
}

/*
 * Returns a map of photons of flux 1 over the square from -1 to 1, count / 4 per unit area,
 * thinned to 1 - dip (1 - r2) within the unit circle.
 */
static struct orl_photon_map *rain(double dip, uint32_t count, uint64_t seed)
{
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_photon *photons = calloc(count, sizeof *photons);
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 1);
    struct orl_photon_map *map = NULL;
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    size_t n = 0;
    char path[128];
    assert_non_null(photons);
    for (uint32_t i = 0; i < count; i++) {
        const double x = 2 * orl_random_uniform(&random) - 1;
        const double y = 2 * orl_random_uniform(&random) - 1, r2 = x * x + y * y;
        if (orl_random_uniform(&random) < 1 - dip * fmax(1 - r2, 0))
            photons[n++] = (struct orl_photon){.position = {(float)x, (float)y, 0},
                                               .flux = {1, 1, 1},
                                               .normal = orl_normal_encode(up),
                                               .batch = (uint8_t)(i % ORL_MAP_BATCHES)};
    }
    snprintf(path, sizeof path, "%s/map", folder);
    assert_int_equal(orl_photon_map_write(path, photons, n, &build, pool, NULL), 0);
    assert_int_equal(orl_photon_map_open(path, false, &map, NULL), 0);
    orl_thread_pool_stop(pool);
    free(photons);
    return map;
}

/*
 * Uniform light. The standard error of fixed discs is the scatter of k photons, 1 / sqrt k; that
 * of adaptive discs is the scatter over many maps. A variance from 100 maps is accurate to sqrt(2
 * / 99) = 14 %, a mean of 100 variances with 15 degrees each to sqrt(2 / 1500) = 4 %: the
 * tolerance is four times 15 % of the logarithm.
 */
static void test_material_sample(void **state)
{
    enum { MAPS = 100, COUNT = 20000 };
    double told[2] = {0}, sum[2] = {0}, squares[2] = {0};
    (void)state;
    for (uint64_t seed = 1; seed <= MAPS; seed++) {
        struct orl_photon_map *map = rain(0, COUNT, seed);
        struct orl_density_query query = {.normal = up, .k = 300, .max_radius = 0.7};
        const struct orl_density fixed = orl_density_estimate(map, &query, search);
        query.k = ORL_ADAPTIVE_DENSITY_MOST;
        struct orl_adaptive_density adapt;
        assert_int_equal(orl_adaptive_density_init(&adapt, map, 0.7, NULL, search), 0);
        const struct orl_density adaptive = orl_adaptive_density_estimate(&adapt, &query, search);
        orl_adaptive_density_done(&adapt);
        const struct orl_density *both[2] = {&fixed, &adaptive};
        for (int i = 0; i < 2; i++) {
            told[i] += both[i]->standard_error * both[i]->standard_error / MAPS;
            sum[i] += both[i]->irradiance.g;
            squares[i] += both[i]->irradiance.g * both[i]->irradiance.g;
        }
        orl_photon_map_free(map);
    }
    for (int i = 0; i < 2; i++) {
        const double seen = (squares[i] - sum[i] * sum[i] / MAPS) / (MAPS - 1);
        print_message("%s: scatter %.4f, told %.4f\n", i ? "adaptive" : "fixed",
                      sqrt(seen) / (COUNT / 4.0), sqrt(told[i]) / (COUNT / 4.0));
        assert_true(fabs(log(seen / told[i])) < 0.6);
    }
}

/*
 * In a dip of 0.8 (1 - r2) the mean over a disc of radius R is too high by 0.4 R2. The bias
 * estimate is the difference of two discs, one half of the other. It scatters by 1 / sqrt 2 of the
 * k photons of the smaller: the tolerance is four times that.
 */
static void test_bias(void **state)
{
    enum { COUNT = 100000, K = 2000 };
    const struct orl_density_query query = {.normal = up, .k = K, .max_radius = 0.9};
    struct orl_photon_map *map = rain(0.8, COUNT, 1);
    (void)state;
    const struct orl_density density = orl_density_estimate(map, &query, search);
    const double even = COUNT / 4.0, bias = orl_density_bias(map, &query, &density, search) / even;
    const double truth = 0.4 * density.radius * density.radius;
    print_message("bias %.4f, by closed form %.4f, seen %.4f\n", bias, truth,
                  density.irradiance.g / even - 0.2);
    assert_true(fabs(bias - truth) < 4 * density.irradiance.g / even / sqrt(2.0 * K));
    orl_photon_map_free(map);
    /* Uniform light has no bias, except by chance. */
    map = rain(0, COUNT, 1);
    const struct orl_density none = orl_density_estimate(map, &query, search);
    assert_true(fabs(orl_density_bias(map, &query, &none, search)) < 2 * none.standard_error);
    orl_photon_map_free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_student),      cmocka_unit_test(test_biased),
        cmocka_unit_test(test_skewed),       cmocka_unit_test(test_sums),
        cmocka_unit_test(test_packed_parts), cmocka_unit_test(test_material_sample),
        cmocka_unit_test(test_bias),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
