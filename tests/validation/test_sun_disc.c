/*
 * The sun in a picture: its flux is its luminance times its solid angle, whatever the pixels' size
 * and its position in a pixel; through glass times its transmittance; half of it behind an edge.
 * Measured on the film's pixels as floats, by the light at the eye that they add up to.
 *
 * The sun's light at the eye is its irradiance times a cosine, exactly. Disc rays use 32 x 32
 * strata: an edge through the disc crosses some 32 of them with an error of half a stratum each, 1
 * % at most. HDR files round to 1/256.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 %.9g %.9g %.9g .533\n"
#define DARK                                                                                       \
    "void plastic w 0 0 5 0 0 0 0 0\nw polygon far 0 0 9 900 900 -900 901 900 -900 900 901 -900\n"

/* Returns the light at the eye of a picture of that scene, lx. */
static double eye_lx(const char *scene, const char *view, uint32_t side,
                     enum orl_technique technique)
{
    const struct scene_run run = {.scene = scene,
                                  .view = view,
                                  .width = side,
                                  .height = side,
                                  .metrics = 1U << ORL_GLARE_ILLUMINANCE,
                                  .technique = technique,
                                  .global = 1000,
                                  .pixel_samples = 1};
    struct orl_result result = scene_run(&run);
    const double lx = result.views[0].glare->values[ORL_GLARE_ILLUMINANCE].value;
    orl_result_done(&result);
    return lx;
}

/* Returns the light of the whole disc straight ahead, per unit of transmittance. */
static double sun_lx(void)
{
    const double half = 0.533 / 2 * ORL_DEG_TO_RAD;
    return 179 * 1e6 * 2 * ORL_PI * (1 - cos(half));
}

static void test_any_place_and_size(void **state)
{
    static const uint32_t sides[] = {60, 200, 400};
    static const char *const views[] = {"-vta -vd 0 1 0 -vh 180 -vv 180",
                                        "-vth -vd 0 1 0 -vh 180 -vv 180",
                                        "-vtv -vd 0 1 0 -vh 130 -vv 130"};
    (void)state;
    for (int v = 0; v < 3; v++)
        for (int s = 0; s < 3; s++)
            for (int place = 0; place < 4; place++) {
                char scene[512];
                const double x = 0.2 + 0.0031 * place, z = 0.3 - 0.0047 * place;
                snprintf(scene, sizeof scene, SUN DARK, x, 1.0, z);
                const double cosine = 1 / sqrt(x * x + 1 + z * z);
                const double found =
                    eye_lx(scene, views[v], sides[s],
                           place & 1 ? ORL_TECHNIQUE_BACKWARD : ORL_TECHNIQUE_GATHER);
                /* Pixels have one cosine each: over 3 degrees at 20 from the axis, 1 % off. */
                if (!(fabs(found / (sun_lx() * cosine) - 1) < (sides[s] < 100 ? 0.012 : 0.004)))
                    fail_msg("%s, %u pixels: %g lx, not %g", views[v], sides[s], found,
                             sun_lx() * cosine);
            }
}

/* Straight through glass: 0.96 of the light in air, transmissivity for normal incidence. */
static void test_through_glass(void **state)
{
    static const char *const techniques[] = {"gather", "backward"};
    char with[768], without[512];
    (void)state;
    snprintf(without, sizeof without, SUN DARK, 0.0, 1.0, 0.0);
    snprintf(with, sizeof with,
             SUN DARK "void glass g 0 0 3 .5 .5 .5\n"
                      "g polygon pane 0 0 12 -9 2 -9 9 2 -9 9 2 9 -9 2 9\n",
             0.0, 1.0, 0.0);
    const char *view = "-vta -vd 0 1 0 -vh 180 -vv 180";
    /* A pane of refractive index 1.52 transmits (1 - r)^2 t / (1 - r^2 t^2). */
    const double r = pow(0.52 / 2.52, 2), t = 0.5;
    const double clear = (1 - r) * (1 - r) * t / (1 - r * r * t * t);
    for (int i = 0; i < 2; i++) {
        const enum orl_technique technique = i ? ORL_TECHNIQUE_BACKWARD : ORL_TECHNIQUE_GATHER;
        const double bare = eye_lx(without, view, 200, technique);
        const double seen = eye_lx(with, view, 200, technique);
        if (!(fabs(seen / bare - clear) < 2e-3))
            fail_msg("%s: %g of it passes, not %g", techniques[i], seen / bare, clear);
    }
}

/* A wall up to the horizon hides the lower half. */
static void test_half_a_disc(void **state)
{
    char scene[512];
    (void)state;
    snprintf(scene, sizeof scene,
             SUN DARK "w polygon half 0 0 12 -90 5 -90 90 5 -90 90 5 0 -90 5 0\n", 0.0, 1.0, 0.0);
    for (uint32_t side = 199; side <= 400; side += 201) {
        const double found =
            eye_lx(scene, "-vta -vd 0 1 0 -vh 180 -vv 180", side, ORL_TECHNIQUE_BACKWARD);
        if (!(fabs(found / sun_lx() - 0.5) < 0.01))
            fail_msg("%u pixels: %g of the sun", side, found / sun_lx());
    }
}

/* Half floats of OpenEXR overflow, and the result has a warning; floats cause none. */
static void test_beyond_halves(void **state)
{
    static const enum orl_picture pictures[] = {ORL_PICTURE_EXR, ORL_PICTURE_EXR_FLOAT};
    char scene[512];
    (void)state;
    snprintf(scene, sizeof scene, SUN DARK, 0.0, 1.0, 0.0);
    for (int i = 0; i < 2; i++) {
        const struct scene_run run = {.scene = scene,
                                      .view = "-vta -vd 0 1 0 -vh 180 -vv 180",
                                      .width = 200,
                                      .height = 200,
                                      .formats = ORL_PICTURE_BIT(pictures[i]),
                                      .technique = ORL_TECHNIQUE_BACKWARD,
                                      .pixel_samples = 1};
        struct orl_result result = scene_run(&run);
        int told = 0;
        for (size_t w = 0; w < result.n_warnings; w++)
            told += strstr(result.warnings[w], "view.exr: radiances above 65504 W/sr/m2") != NULL;
        assert_int_equal(told, pictures[i] == ORL_PICTURE_EXR);
        orl_result_done(&result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_place_and_size), cmocka_unit_test(test_through_glass),
        cmocka_unit_test(test_half_a_disc), cmocka_unit_test(test_beyond_halves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
