/* Polar maps of a BSDF against its albedo: cells hold all of the light, at the right places. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf/bsdf_polar.h>

#include "fixtures/bsdf_ask.h"
#include "support/scene_text.h"

static struct orl_bsdf *load(const char *text, size_t size)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err;
    if (orl_bsdf_load_xml("polar.xml", text, size, &bsdf, &err))
        fail_msg("%s", err.message);
    return bsdf;
}

static double light_of(double values[ORL_POLAR_THETAS][ORL_POLAR_PHIS])
{
    const double step = ORL_PI / 2 / ORL_POLAR_THETAS, turn = 2 * ORL_PI / ORL_POLAR_PHIS;
    double light = 0;
    for (int i = 0; i < ORL_POLAR_THETAS; i++) {
        const double low = sin(i * step), high = sin((i + 1) * step);
        for (int k = 0; k < ORL_POLAR_PHIS; k++)
            light += values[i][k] * turn * (high * high - low * low) / 2;
    }
    return light;
}

static void test_uniform(void **state)
{
    static struct orl_bsdf_polar polar;
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.1, xml);
    struct orl_bsdf *bsdf = load(xml, strlen(xml));
    orl_bsdf_polar(bsdf, true, 30, 45, &polar);
    assert_close(polar.transmitted, 0.1 * ORL_PI, 1e-6);
    assert_close(polar.reflected, 0, 0);
    for (int i = 0; i < ORL_POLAR_THETAS; i++)
        for (int k = 0; k < ORL_POLAR_PHIS; k++) {
            assert_close(polar.values[1][i][k], 0.1, 1e-7);
            assert_close(polar.values[0][i][k], 0, 0);
        }
    orl_bsdf_unref(bsdf);
}

/*
 * Matrices and trees. Sixteen points per cell are inexact where a border of the data crosses it: a
 * cell is wrong by at most 1/8 of the difference of its two values, with random sign. Over the
 * hundreds of cells on borders that is far less than 3 % of the light.
 */
static void test_all_of_the_light(void **state)
{
    static const char *const fixtures[] = {"tests/fixtures/bsdf_klems41.xml",
                                           "tests/fixtures/bsdf_lcp8.xml"};
    static struct orl_bsdf_polar polar;
    (void)state;
    for (int f = 0; f < 2; f++) {
        size_t size;
        char *text = (char *)scene_read_bytes(fixtures[f], &size);
        struct orl_bsdf *bsdf = load(text, size);
        for (int side = 0; side < 2; side++)
            for (int i = 0; i < 3; i++) {
                orl_bsdf_polar(bsdf, side == 1, 7 + 27 * i, 91 * i, &polar);
                assert_true(polar.transmitted + polar.reflected > 0.01);
                assert_close(light_of(polar.values[0]), polar.reflected,
                             0.03 * polar.reflected + 1e-9);
                assert_close(light_of(polar.values[1]), polar.transmitted,
                             0.03 * polar.transmitted + 1e-9);
            }
        orl_bsdf_unref(bsdf);
        free(text);
    }
}

/* A cell's value is f at the direction of its middle, where f is uniform. */
static void test_places(void **state)
{
    static struct orl_bsdf_polar polar;
    size_t size;
    (void)state;
    char *text = (char *)scene_read_bytes("tests/fixtures/bsdf_klems41.xml", &size);
    struct orl_bsdf *bsdf = load(text, size);
    const double theta = 33 * ORL_DEG_TO_RAD, phi = 112 * ORL_DEG_TO_RAD;
    const struct orl_vec3 in =
        orl_v3(sin(theta) * cos(phi), sin(theta) * sin(phi), -cos(theta)); /* from the back */
    int even = 0;
    orl_bsdf_polar(bsdf, false, 33, 112, &polar);
    for (int i = 0; i < ORL_POLAR_THETAS; i++)
        for (int k = 0; k < ORL_POLAR_PHIS; k++)
            for (int through = 0; through < 2; through++) {
                double values[5];
                bool same = true;
                for (int p = 0; p < 5; p++) { /* the middle, then the corners */
                    const double t = (i + 0.5 + (p ? 0.49 * (p & 1 ? 1 : -1) : 0)) * 2.5;
                    const double a = (k + 0.5 + (p ? 0.49 * (p & 2 ? 1 : -1) : 0)) * 5;
                    const double sine = sin(t * ORL_DEG_TO_RAD);
                    values[p] = orl_luma(
                        orl_bsdf_eval(bsdf, in,
                                      direction(sine * cos(a * ORL_DEG_TO_RAD),
                                                sine * sin(a * ORL_DEG_TO_RAD), through ? 1 : -1)));
                    same = same && values[p] == values[0];
                }
                if (same)
                    assert_close(polar.values[through][i][k], values[0], 1e-12 + 1e-9 * values[0]);
                even += same;
            }
    assert_true(even > ORL_POLAR_THETAS * ORL_POLAR_PHIS / 2);
    orl_bsdf_unref(bsdf);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_uniform),
                                       cmocka_unit_test(test_all_of_the_light),
                                       cmocka_unit_test(test_places)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
