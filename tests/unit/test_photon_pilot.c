/* The contrast of caustics: their share of the light where they land, against known fluxes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "photon/map/quantization.h"
#include "photon/shooting/shoot.h"

enum { REST = 30000, CAUSTIC = 4000 };

/* Returns photons uniform over a square of the floor, with that total flux. */
static struct orl_photon *lay(size_t count, double side, double flux, uint8_t class, uint64_t name)
{
    struct orl_photon *photons = calloc(count, sizeof *photons);
    struct orl_random random = orl_random_stream(name, ORL_PURPOSE_BENCH, 0);
    const float each = (float)(flux / (double)count);
    assert_non_null(photons);
    for (size_t i = 0; i < count; i++)
        photons[i] = (struct orl_photon){
            .position = {(float)(side * (orl_random_uniform(&random) - 0.5)),
                         (float)(side * (orl_random_uniform(&random) - 0.5)), 0},
            .flux = {each, each, each},
            .normal = orl_normal_encode(orl_v3(0, 0, 1)),
            .tag = class};
    return photons;
}

static double contrast(double side, double flux, uint8_t class_of_rest)
{
    const struct orl_geometry box = {.radius = 1};
    struct orl_photon *caustic = lay(CAUSTIC, side, flux, ORL_PHOTON_CAUSTIC, 1),
                      *rest = lay(REST, 1, 1, class_of_rest, 2);
    double found = -1;
    assert_int_equal(orl_photon_pilot_contrast(caustic, CAUSTIC, 1, rest, REST, 1, &box, &found),
                     0);
    free(caustic);
    free(rest);
    return found;
}

/*
 * A cube with n photons of a kind gives their density to 1 / sqrt n, and n is at least 8: for
 * shares near 0 or 1, this is the relative error of the smaller part. The average over 4000
 * photons is much better, except for the bias of choosing small cubes, which favours full ones.
 */
static void expect_near(double found, double wanted)
{
    print_message("contrast %.4f, by closed form %.4f\n", found, wanted);
    assert_true(found > 0.7 * wanted && found < 1.5 * wanted);
    assert_true(1 - found > 0.6 * (1 - wanted) && 1 - found < 1.5 * (1 - wanted));
}

/* A per cent of the light, spread over the whole floor, is a per cent of the light at any place. */
static void test_a_gleam(void **state)
{
    (void)state;
    expect_near(contrast(1, 0.01, ORL_PHOTON_INDIRECT), 0.01 / 1.01);
    expect_near(contrast(1, 1, ORL_PHOTON_INDIRECT), 0.5);
}

/* On a thousandth of the floor or less, the caustic is at least ten times as bright as the rest. */
static void test_a_spot(void **state)
{
    (void)state;
    for (double side = 1.0 / 32; side > 1e-3; side /= 4) {
        const double there = 0.01 / (side * side);
        expect_near(contrast(side, 0.01, ORL_PHOTON_INDIRECT), there / (1 + there));
    }
}

/* Caustic photons in the global map do not count as other light. */
static void test_caustics_among_the_rest(void **state)
{
    (void)state;
    assert_true(contrast(1, 0.01, ORL_PHOTON_CAUSTIC) > 0.999);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_gleam),
                                       cmocka_unit_test(test_a_spot),
                                       cmocka_unit_test(test_caustics_among_the_rest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
