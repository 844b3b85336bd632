/*
 * The sun reaches a dark box by two small mirrors in a black shaft. It is found however much light
 * other mirrors get, of which a large one lies outdoors: E = .9^2 times the sun's own illuminance.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/scene_text.h"

/* The shaft is 0.2 m wide. Its upper mirror sends the sun, at 45 degrees, straight down; its lower
 * one sends it into the box, along x. Polygons face the light's way. */
#define PERISCOPE                                                                                  \
    "void plastic k 0 0 5 0 0 0 0 0\nvoid mirror m 0 0 3 .9 .9 .9\n"                               \
    "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"                             \
    "k polygon s1 0 0 12 -.1 -.1 .2 .1 -.1 .2 .1 -.1 2.2 -.1 -.1 2.2\n"                            \
    "k polygon s2 0 0 12 -.1 .1 .2 -.1 .1 2.2 .1 .1 2.2 .1 .1 .2\n"                                \
    "k polygon s3 0 0 12 -.1 -.1 0 -.1 -.1 2.2 -.1 .1 2.2 -.1 .1 0\n"                              \
    "k polygon s4 0 0 12 .1 -.1 .2 .1 .1 .2 .1 .1 2.2 .1 -.1 2.2\n"                                \
    "m polygon low 0 0 12 -.1 -.1 .2 .1 -.1 0 .1 .1 0 -.1 .1 .2\n"                                 \
    "m polygon top 0 0 12 -.1 .1036 2.3207 .1 .1036 2.3207 .1 -.0036 2.5793 -.1 -.0036 2.5793\n"
/* The box without its side towards the shaft, and that side with an opening of 0.2 m. */
#define BOX                                                                                        \
    "k polygon b1 0 0 12 .1 -1 -.2 2.1 -1 -.2 2.1 1 -.2 .1 1 -.2\n"                                \
    "k polygon b2 0 0 12 .1 -1 1.2 .1 1 1.2 2.1 1 1.2 2.1 -1 1.2\n"                                \
    "k polygon b3 0 0 12 2.1 -1 -.2 2.1 -1 1.2 2.1 1 1.2 2.1 1 -.2\n"                              \
    "k polygon b4 0 0 12 .1 -1 -.2 .1 -1 1.2 2.1 -1 1.2 2.1 -1 -.2\n"                              \
    "k polygon b5 0 0 12 .1 1 -.2 2.1 1 -.2 2.1 1 1.2 .1 1 1.2\n"                                  \
    "k polygon e1 0 0 12 .1 -1 -.2 .1 1 -.2 .1 1 0 .1 -1 0\n"                                      \
    "k polygon e2 0 0 12 .1 -1 .2 .1 1 .2 .1 1 1.2 .1 -1 1.2\n"                                    \
    "k polygon e3 0 0 12 .1 -1 0 .1 -.1 0 .1 -.1 .2 .1 -1 .2\n"                                    \
    "k polygon e4 0 0 12 .1 .1 0 .1 1 0 .1 1 .2 .1 .1 .2\n"
#define LARGE_MIRROR "m polygon large 0 0 12 10 -50 -.5 110 -50 -.5 110 50 -.5 10 50 -.5\n"

static void expect_sun(const char *scene, enum orl_technique technique)
{
    static const struct orl_sensor sensor = {{1.5, 0.03, 0.08}, {-1, 0, 0}};
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    const double sun_lx =
        ORL_EFFICACY_LM_PER_W * 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = &sensor,
                                                        .n_sensors = 1,
                                                        .technique = technique,
                                                        .caustic = 10000,
                                                        .samples = 256});
    const double off = r.illuminance_lx[0] - 0.81 * sun_lx;
    if (!(fabs(off) < 4 * r.standard_error_lx[0] + 1e-3 * sun_lx))
        fail_msg("%g +- %g lx, not %g", r.illuminance_lx[0], r.standard_error_lx[0], 0.81 * sun_lx);
    orl_result_done(&r);
}

static void test_a_periscope_alone(void **state)
{
    (void)state;
    expect_sun(PERISCOPE BOX, ORL_TECHNIQUE_BACKWARD);
}

static void test_a_periscope_beside_a_large_mirror(void **state)
{
    (void)state;
    expect_sun(PERISCOPE BOX LARGE_MIRROR, ORL_TECHNIQUE_BACKWARD);
    expect_sun(PERISCOPE BOX LARGE_MIRROR, ORL_TECHNIQUE_GATHER);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_periscope_alone),
                                       cmocka_unit_test(test_a_periscope_beside_a_large_mirror)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
