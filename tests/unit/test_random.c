/*
 * Random numbers: streams that never coincide and are uniform; Sobol points that fill every
 * elementary interval.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"

static int compare_words(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* First words of streams of many seeds, purposes and indices: all different (64 bits each). */
static void test_streams_differ(void **state)
{
    enum { SEEDS = 40, PURPOSES = 5, INDICES = 500, COUNT = SEEDS * PURPOSES * INDICES };
    uint64_t *words = malloc(COUNT * sizeof *words);
    size_t n = 0;
    (void)state;
    assert_non_null(words);
    for (uint64_t s = 0; s < SEEDS; s++) {
        for (int p = ORL_PURPOSE_PILOT; p < ORL_PURPOSE_PILOT + PURPOSES; p++) {
            for (uint64_t i = 0; i < INDICES; i++) {
                struct orl_random r = orl_random_stream(s, (enum orl_purpose)p, i);
                words[n++] = orl_random_bits(&r);
            }
        }
    }
    qsort(words, n, sizeof *words, compare_words);
    for (size_t i = 1; i < n; i++)
        assert_true(words[i] != words[i - 1]);
    free(words);
}

static void test_streams_repeat(void **state)
{
    struct orl_random a = orl_random_stream(1, ORL_PURPOSE_PHOTON, 17);
    struct orl_random b = orl_random_stream(1, ORL_PURPOSE_PHOTON, 17);
    (void)state;
    for (int i = 0; i < 100; i++)
        assert_true(orl_random_bits(&a) == orl_random_bits(&b));
}

/* Returns Pearson's chi-square of counts against their mean. */
static double chi_square(const uint32_t *counts, size_t n, double mean)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (counts[i] - mean) * (counts[i] - mean) / mean;
    return sum;
}

/* Returns the 99.99 % quantile of chi-square with n degrees of freedom, by Wilson and Hilferty. */
static double chi_square_bound(double n)
{
    const double c = 2 / (9 * n), root = 1 - c + 3.72 * sqrt(c);
    return n * root * root * root;
}

/* Mean 1/2 (variance 1/12) and variance 1/12 (of which the variance is 1/180), 4 sigma. */
static void check_uniform(double (*draw)(uint64_t i, void *arg), void *arg)
{
    enum { DRAWS = 1 << 20, BINS = 1024 };
    static uint32_t counts[BINS];
    double sum = 0, squares = 0;
    for (int b = 0; b < BINS; b++)
        counts[b] = 0;
    for (uint64_t i = 0; i < DRAWS; i++) {
        const double u = draw(i, arg);
        assert_true(u >= 0 && u < 1);
        counts[(int)(u * BINS)]++;
        sum += u / DRAWS;
        squares += (u - 0.5) * (u - 0.5) / DRAWS;
    }
    assert_true(fabs(sum - 0.5) < 4 * sqrt(1.0 / 12 / DRAWS));
    assert_true(fabs(squares - 1.0 / 12) < 4 * sqrt(1.0 / 180 / DRAWS));
    assert_true(chi_square(counts, BINS, (double)DRAWS / BINS) < chi_square_bound(BINS - 1));
}

static double draw_along(uint64_t i, void *arg)
{
    (void)i;
    return orl_random_uniform(arg);
}

static double draw_across(uint64_t i, void *arg)
{
    struct orl_random r = orl_random_stream(*(uint64_t *)arg, ORL_PURPOSE_PHOTON, i);
    return orl_random_uniform(&r);
}

/* Numbers along one stream, and the first numbers of neighbouring streams. */
static void test_uniform(void **state)
{
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_PIXEL, 4);
    uint64_t seed = 5;
    (void)state;
    check_uniform(draw_along, &random);
    check_uniform(draw_across, &seed);
}

/* Seeds s and s + 1, index by index: correlation below 3 / sqrt N. */
static void test_seeds_uncorrelated(void **state)
{
    enum { DRAWS = 1 << 18 };
    (void)state;
    for (uint64_t seed = 0; seed < 4; seed++) {
        double covariance = 0;
        for (uint64_t i = 0; i < DRAWS; i++) {
            struct orl_random a = orl_random_stream(seed, ORL_PURPOSE_PHOTON, i);
            struct orl_random b = orl_random_stream(seed + 1, ORL_PURPOSE_PHOTON, i);
            covariance += (orl_random_uniform(&a) - 0.5) * (orl_random_uniform(&b) - 0.5) / DRAWS;
        }
        assert_true(fabs(covariance * 12) < 3 / sqrt(DRAWS));
    }
}

/* ---- Sobol ------------------------------------------------------------------------------------
 */

/*
 * 2^8 points from a multiple of 2^8 on hit every interval of length 2^-8 in each dimension once.
 * Dimensions 0 and 1 are a (0,2)-sequence: each box of 2^-a by 2^-(8-a) is also hit once.
 */
static void check_block(const struct orl_sobol *sobol, uint32_t first, uint32_t seed)
{
    for (int a = 0; a <= 8; a++) {
        unsigned char hit[ORL_SOBOL_DIMENSIONS][256] = {{0}}, box[256] = {0};
        for (uint32_t i = 0; i < 256; i++) {
            double p[ORL_SOBOL_DIMENSIONS];
            orl_sobol_point(sobol, first + i, seed, ORL_SOBOL_DIMENSIONS, p);
            for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++) {
                assert_true(p[d] >= 0 && p[d] < 1);
                assert_int_equal(hit[d][(int)(p[d] * 256)]++, 0);
            }
            const int x = (int)(p[0] * (1 << a)), y = (int)(p[1] * (1 << (8 - a)));
            assert_int_equal(box[x << (8 - a) | y]++, 0);
        }
    }
}

static void test_elementary_boxes(void **state)
{
    struct orl_sobol sobol;
    (void)state;
    orl_sobol_init(&sobol);
    for (uint32_t seed = 0; seed < 20; seed++) {
        check_block(&sobol, 0, seed);
        check_block(&sobol, 256 * 5, seed);
        check_block(&sobol, 1U << 20, seed);
        check_block(&sobol, UINT32_MAX - 255, seed);
    }
}

/*
 * Every pair of dimensions is more uniform than random points: 2^12 points in 32 x 32 boxes, four
 * each. Random points would have a chi-square of about 1023. The worst pair of dimensions has a
 * net of quality t = 3 or so, a few boxes doubled, and stays below half of that.
 */
static void test_projections(void **state)
{
    struct orl_sobol sobol;
    (void)state;
    orl_sobol_init(&sobol);
    for (int a = 0; a < ORL_SOBOL_DIMENSIONS; a++) {
        for (int b = 0; b < a; b++) {
            static uint32_t counts[1024];
            for (int i = 0; i < 1024; i++)
                counts[i] = 0;
            for (uint32_t i = 0; i < 4096; i++) {
                double p[ORL_SOBOL_DIMENSIONS];
                orl_sobol_point(&sobol, i, 7, ORL_SOBOL_DIMENSIONS, p);
                counts[(int)(p[a] * 32) * 32 + (int)(p[b] * 32)]++;
            }
            assert_true(chi_square(counts, 1024, 4) < 512);
        }
    }
}

/* Sequences of two seeds are as independent as random ones, point by point. */
static void test_sobol_seeds(void **state)
{
    enum { POINTS = 1 << 16 };
    struct orl_sobol sobol;
    (void)state;
    orl_sobol_init(&sobol);
    for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++) {
        double covariance = 0;
        int same = 0;
        for (uint32_t i = 0; i < POINTS; i++) {
            double p[ORL_SOBOL_DIMENSIONS], q[ORL_SOBOL_DIMENSIONS];
            orl_sobol_point(&sobol, i, 11, ORL_SOBOL_DIMENSIONS, p);
            orl_sobol_point(&sobol, i, 12, ORL_SOBOL_DIMENSIONS, q);
            covariance += (p[d] - 0.5) * (q[d] - 0.5) / POINTS;
            same += p[d] == q[d];
        }
        assert_true(fabs(covariance * 12) < 4 / sqrt(POINTS));
        assert_true(same < 4);
    }
}

/* Points of 16 sequences computed at once equal those of each, to the bit, for any vector width. */
static void test_blocks(void **state)
{
    struct orl_sobol sobol;
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 0);
    (void)state;
    orl_sobol_init(&sobol);
    for (int i = 0; i < 1000; i++) {
        const uint32_t index = (uint32_t)orl_random_bits(&random);
        uint32_t seeds[ORL_SOBOL_BLOCK];
        struct orl_sobol_block block;
        for (int k = 0; k < ORL_SOBOL_BLOCK; k++)
            seeds[k] = (uint32_t)orl_random_bits(&random);
        orl_sobol_block(&sobol, index, seeds, &block);
        for (int k = 0; k < ORL_SOBOL_BLOCK; k++) {
            double p[ORL_SOBOL_DIMENSIONS];
            orl_sobol_point(&sobol, index, seeds[k], ORL_SOBOL_DIMENSIONS, p);
            for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++)
                assert_true(p[d] == block.at[d][k]);
        }
    }
}

/* orl_sincos_small is within an ulp of 1, and so is orl_sincos_turn over the whole turn. */
static void test_circle(void **state)
{
    (void)state;
    for (int i = 0; i <= 1000000; i++) {
        const double turn = i / 1e6, angle = (i / 5e5 - 1) * ORL_PI / 4;
        const struct orl_sincos c = orl_sincos_turn(turn), n = orl_sincos_small(angle);
        assert_true(fabs(c.cosine - cos(2 * ORL_PI * turn)) < 1e-15);
        assert_true(fabs(c.sine - sin(2 * ORL_PI * turn)) < 1e-15);
        assert_true(fabs(n.cosine - cos(angle)) < 3e-16 && fabs(n.sine - sin(angle)) < 3e-16);
    }
}

/* Means over the points converge much faster than random ones: x y over 2^16 points, to 1e-5
 * rather than 1e-3. */
static void test_integral(void **state)
{
    enum { POINTS = 1 << 16 };
    struct orl_sobol sobol;
    double sum = 0;
    (void)state;
    orl_sobol_init(&sobol);
    for (uint32_t i = 0; i < POINTS; i++) {
        double p[2];
        orl_sobol_point(&sobol, i + (1U << 17), 3, 2, p);
        sum += p[0] * p[1] / POINTS;
    }
    assert_true(fabs(sum - 0.25) < 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_streams_differ),   cmocka_unit_test(test_streams_repeat),
        cmocka_unit_test(test_uniform),          cmocka_unit_test(test_seeds_uncorrelated),
        cmocka_unit_test(test_elementary_boxes), cmocka_unit_test(test_projections),
        cmocka_unit_test(test_sobol_seeds),      cmocka_unit_test(test_integral),
        cmocka_unit_test(test_blocks),           cmocka_unit_test(test_circle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
