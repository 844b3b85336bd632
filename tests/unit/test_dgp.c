/*
 * Daylight glare probability: published constants and evalglare's, worked out by hand; darkness;
 * refusals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "metrics/indices.h"

#define SOURCE(luminance, solid_angle, index)                                                      \
    {                                                                                              \
        .luminance_cd_m2 = (luminance), .solid_angle_sr = (solid_angle), .position_index = (index) \
    }

static const struct orl_dgp_options published = {ORL_DGP_PUBLISHED, false};
static const struct orl_dgp_options evalglare = {ORL_DGP_EVALGLARE, false};

static double dgp_with(const struct orl_dgp_options *options, double eye_lx, size_t n,
                       const struct orl_glare_source *sources)
{
    double dgp = -1;
    assert_int_equal(orl_dgp(eye_lx, sources, n, options, &dgp, NULL), 0);
    return dgp;
}

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

/* The last given digit is the tolerance. */
static void test_evalglares_constants(void **state)
{
    const struct orl_glare_source lamp = SOURCE(2e4, 0.1, 1);
    const struct orl_glare_source two[2] = {SOURCE(5000, 0.05, 1.5), SOURCE(3e4, 0.01, 3)};
    (void)state;
    assert_near(dgp_with(&evalglare, 1000, 0, NULL), 0.2177, 1e-12);
    assert_near(dgp_with(&evalglare, 3000, 1, &lamp), 0.43934, 1e-5);
    assert_near(dgp_with(&evalglare, 2000, 2, two), 0.30498, 1e-5);
}

/* The sun is 1e9 cd/m2 over 6.8e-5 sr: 1.064 before the cut. */
static void test_cut_to_1(void **state)
{
    const struct orl_glare_source sun = SOURCE(1e9, 6.8e-5, 2), weaker = SOURCE(1e7, 6.8e-5, 2);
    (void)state;
    assert_true(dgp_with(&evalglare, 5000, 1, &sun) == 1);
    assert_true(dgp_with(&evalglare, 5000, 1, &weaker) < 1);
    assert_true(dgp_with(&evalglare, 1e300, 0, NULL) == 1);
}

/* Only the constants differ. */
static void test_published_constants(void **state)
{
    const struct orl_glare_source lamp = SOURCE(2e4, 0.1, 1);
    const double sum = 4e8 * 0.1 / pow(3000, 1.87);
    (void)state;
    assert_near(dgp_with(&published, 1000, 0, NULL), 0.0587 + 0.16, 1e-12);
    assert_near(dgp_with(&published, 3000, 1, &lamp), 0.1761 + 0.0918 * log10(1 + sum) + 0.16,
                1e-12);
}

/* Halfway at 4 / 0.024 lx; without effect from 1000 lx on. */
static void test_low_light(void **state)
{
    const struct orl_dgp_options low = {ORL_DGP_EVALGLARE, true};
    const double half = 4 / 0.024;
    (void)state;
    assert_near(dgp_with(&low, half, 0, NULL), 0.5 * (5.87e-5 * half + 0.159), 1e-12);
    assert_near(dgp_with(&low, 0, 0, NULL), 0.159 / (1 + exp(4)), 1e-12);
    assert_true(dgp_with(&low, 1000, 0, NULL) == dgp_with(&evalglare, 1000, 0, NULL));
    assert_near(dgp_with(&low, 999.999, 0, NULL), dgp_with(&evalglare, 999.999, 0, NULL), 1e-8);
}

/* Without light, or with almost none, there is no contrast, for any list of sources. */
static void test_dark(void **state)
{
    const struct orl_glare_source lamp = SOURCE(2e4, 0.1, 1), nothing = SOURCE(0, 0, 1),
                                  faint = SOURCE(1e-320, 1, 1);
    (void)state;
    assert_true(dgp_with(&published, 0, 0, NULL) == 0.16);
    assert_true(dgp_with(&published, 0, 1, &lamp) == 0.16);
    assert_true(dgp_with(&published, 5e-324, 1, &lamp) == 1);
    assert_near(dgp_with(&published, 5e-324, 1, &nothing), 0.16, 1e-15);
    assert_near(dgp_with(&published, 100, 1, &faint), 0.16 + 5.87e-3, 1e-15);
}

static void test_refusals(void **state)
{
    static const struct orl_glare_source broken[] = {SOURCE(NAN, 0.1, 1),    SOURCE(-1, 0.1, 1),
                                                     SOURCE(1, INFINITY, 1), SOURCE(1, -0.1, 1),
                                                     SOURCE(1, 0.1, 0),      SOURCE(1, 0.1, NAN)};
    double dgp = 7;
    struct orl_error err;
    (void)state;
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
        assert_int_equal(orl_dgp(100, &broken[i], 1, &published, &dgp, &err), ORL_ERR_RANGE);
    assert_int_equal(orl_dgp(NAN, NULL, 0, &published, &dgp, &err), ORL_ERR_RANGE);
    assert_int_equal(orl_dgp(INFINITY, NULL, 0, &published, &dgp, &err), ORL_ERR_RANGE);
    assert_int_equal(orl_dgp(-1, NULL, 0, &published, &dgp, &err), ORL_ERR_RANGE);
    assert_true(dgp == 7);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_evalglares_constants),
        cmocka_unit_test(test_cut_to_1),
        cmocka_unit_test(test_published_constants),
        cmocka_unit_test(test_low_light),
        cmocka_unit_test(test_dark),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
