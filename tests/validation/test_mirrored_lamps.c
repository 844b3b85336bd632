/*
 * Lamps that a sensor sees only in a flat mirror, compared with closed forms: a sphere, a ring, a
 * spotlight with a focus, a narrow one, a glow, and a sphere seen through a pane. All else is
 * black, so that the sensor's only light is that of the virtual lamp (light/virtual_lamps.h).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/scene_text.h"
#include "support/techniques.h"

#define MIRROR                                                                                     \
    "void mirror m 0 0 3 .8 .8 .8\n"                                                               \
    "m polygon wall 0 0 12 2 -3 0 2 -3 3 2 3 3 2 3 0\n"
/* A pane between the sensor and the mirror only. */
#define PANE                                                                                       \
    "void glass g 0 0 3 .9 .9 .9\n"                                                                \
    "g polygon pane 0 0 12 .5 -.2 .8 .5 .2 .8 .5 .2 1.2 .5 -.2 1.2\n"
#define LAMP_AT "-.5 1 1.2"

/* The mirror shows a lamp at LAMP_AT, behind the sensor, at (4.5, 1, 1.2). */
static const struct orl_sensor sensor = {{0, 0, 1}, {1, 0, 0}};
static const double ahead = 4.5, distance2 = 4.5 * 4.5 + 1 + 0.04, mirrored = 0.8;

/* Photons contribute nothing here, and no technique needs random hits on the lamp: the remaining
 * error is the scatter of the solid angle between points of the lamp, 1e-3 at most. */
static void check_irradiance(void **state, const char *scene, double irradiance)
{
    double lx;
    scene_run_lx(&(struct scene_run){.scene = scene,
                                     .sensors = &sensor,
                                     .n_sensors = 1,
                                     .technique = of_technique(state),
                                     .samples = 1024,
                                     .caustic = 20000},
                 &lx);
    const double expected = ORL_EFFICACY_LM_PER_W * irradiance;
    print_message("%.5f of %.3f lx\n", lx / expected, expected);
    assert_true(fabs(lx / expected - 1) < 2e-3);
}

/* A sphere above the horizon: pi L (r / d)^2 cos. */
static double of_sphere(double radius)
{
    return mirrored * ORL_PI * 1e4 * radius * radius / distance2 * ahead / sqrt(distance2);
}

/* A ring that faces the mirror. */
static double of_ring(double radius)
{
    return mirrored * 1e4 * ORL_PI * radius * radius * ahead * ahead / (distance2 * distance2);
}

static void test_sphere(void **state)
{
    check_irradiance(state,
                     MIRROR "void light l 0 0 3 1e4 1e4 1e4\nl sphere lamp 0 0 4 " LAMP_AT " .1\n",
                     of_sphere(0.1));
}

static void test_glow(void **state)
{
    check_irradiance(state,
                     MIRROR "void glow l 0 0 4 1e4 1e4 1e4 0\nl sphere lamp 0 0 4 " LAMP_AT " .1\n",
                     of_sphere(0.1));
}

static void test_ring(void **state)
{
    check_irradiance(
        state, MIRROR "void light l 0 0 3 1e4 1e4 1e4\nl ring lamp 0 0 8 " LAMP_AT " 1 0 0 0 .05\n",
        of_ring(0.05));
}

/* The focus widens the beam over the whole path, past the mirror: (d / (d + f))^2. */
static void test_spotlight(void **state)
{
    const double d = sqrt(distance2), spread = d / (d + 2);
    check_irradiance(state,
                     MIRROR "void spotlight l 0 0 7 1e4 1e4 1e4 60 2 0 0\n"
                            "l ring lamp 0 0 8 " LAMP_AT " 1 0 0 0 .05\n",
                     of_ring(0.05) * spread * spread);
}

/* A beam of 1.5 degrees down onto a mirror that reflects it to the sensor, over 3 m and 1.9 m. */
static void test_narrow_beam(void **state)
{
    const double d = 3 + 1.9, spread = d / (d + 1e-3);
    check_irradiance(state,
                     "void mirror m 0 0 3 .8 .8 .8\n"
                     "m polygon tilted 0 0 12 1.8 -.1 .9 2 -.1 1.1 2 .1 1.1 1.8 .1 .9\n"
                     "void spotlight l 0 0 7 1e4 1e4 1e4 1.5 0 0 -.001\n"
                     "l ring lamp 0 0 8 1.9 0 4 0 0 -1 0 .02\n",
                     mirrored * 1e4 * ORL_PI * 0.02 * 0.02 / (d * d) * spread * spread);
}

static void test_through_pane(void **state)
{
    static const struct orl_hit anywhere = {.normal = {-1, 0, 0}, .front = true};
    static const char scene[] =
        PANE MIRROR "void light l 0 0 3 1e4 1e4 1e4\nl sphere lamp 0 0 4 " LAMP_AT " .1\n";
    struct orl_parsed_scene d = scene_parse_text(scene, NULL, NULL);
    const struct orl_material *glass = &d.materials[d.surfaces[0].material];
    const double t = orl_glass_transmittance(glass, &anywhere, ahead / sqrt(distance2)).g;
    orl_parsed_scene_done(&d);
    check_irradiance(state, scene, of_sphere(0.1) * t);
}

/* 150 spheres in a plane: more pairs than the 64 that are always kept. */
static void test_many_lamps(void **state)
{
    enum { ROWS = 10, COLUMNS = 15 };
    static char scene[16384];
    double irradiance = 0;
    int at = snprintf(scene, sizeof scene, MIRROR "void light l 0 0 3 1e4 1e4 1e4\n");
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        const double y = -2.1 + 0.3 * (i % COLUMNS), z = 0.2 + 0.16 * (double)(i / COLUMNS);
        const double d2 = ahead * ahead + y * y + (z - 1) * (z - 1);
        at += snprintf(scene + at, sizeof scene - (size_t)at,
                       "l sphere l%d 0 0 4 -.5 %.9g %.9g .02\n", i, y, z);
        irradiance += mirrored * ORL_PI * 1e4 * 0.02 * 0.02 / d2 * ahead / sqrt(d2);
    }
    check_irradiance(state, scene, irradiance);
}

/*
 * Between two facing mirrors the lamp has infinitely many images: those ahead are
 * at 4.5, 7.5, 12.5, 15.5, ..., one reflection more each. Only the first is a virtual lamp.
 */
static const char facing[] = MIRROR "m polygon other 0 0 12 -2 -3 0 -2 3 0 -2 3 3 -2 -3 3\n"
                                    "void light l 0 0 3 1e4 1e4 1e4\n"
                                    "l sphere lamp 0 0 4 " LAMP_AT " .05\n";

static double of_facing_mirrors(void)
{
    enum { IMAGES = 60 };
    double sum = 0, share = mirrored;
    for (int i = 0; i < IMAGES; i++, share *= mirrored) {
        const double far = 4.5 + 8 * (i / 2) + (i % 2 ? 3 : 0), d2 = far * far + 1 + 0.04;
        sum += share * ORL_PI * 1e4 * 0.05 * 0.05 / d2 * far / sqrt(d2);
    }
    return ORL_EFFICACY_LM_PER_W * sum;
}

static struct orl_result run_facing_mirrors(enum orl_technique technique)
{
    return scene_run(&(struct scene_run){.scene = facing,
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .technique = technique,
                                         .by_plan = true,
                                         .samples = 1024,
                                         .global = 20000,
                                         .caustic = 100000});
}

/* Photons find the light that virtual lamps leave out, a third of the light here. */
static void test_facing_mirrors(void **state)
{
    struct orl_result r = run_facing_mirrors(ORL_TECHNIQUE_AUTO);
    const double expected = of_facing_mirrors();
    (void)state;
    print_message("%.1f [%.1f, %.1f] of %.1f lx\n", r.illuminance_lx[0], r.interval_95_lx[0][0],
                  r.interval_95_lx[0][1], expected);
    assert_int_equal(r.plan.technique, ORL_TECHNIQUE_GATHER);
    assert_null(r.doubts);
    assert_true(fabs(r.illuminance_lx[0] / expected - 1) < 0.1);
    assert_true(r.interval_95_lx[0][0] < expected && expected < r.interval_95_lx[0][1]);
    orl_result_done(&r);
}

/* With paths only the interval is widened, and the sensor is unreliable. */
static void test_facing_mirrors_by_paths(void **state)
{
    struct orl_result r = run_facing_mirrors(ORL_TECHNIQUE_BACKWARD);
    const double expected = of_facing_mirrors();
    (void)state;
    print_message("%.1f [%.1f, %.1f] of %.1f lx\n", r.illuminance_lx[0], r.interval_95_lx[0][0],
                  r.interval_95_lx[0][1], expected);
    assert_true(r.doubts && r.doubts[0] == ORL_DOUBT_MISSED_LIGHT);
    assert_true(r.interval_95_lx[0][0] < expected && expected < r.interval_95_lx[0][1]);
    orl_result_done(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OF_TECHNIQUE(test_sphere, BACKWARD),       OF_TECHNIQUE(test_sphere, GATHER),
        OF_TECHNIQUE(test_sphere, PRECOMPUTED),    OF_TECHNIQUE(test_glow, BACKWARD),
        OF_TECHNIQUE(test_glow, GATHER),           OF_TECHNIQUE(test_ring, BACKWARD),
        OF_TECHNIQUE(test_ring, GATHER),           OF_TECHNIQUE(test_spotlight, BACKWARD),
        OF_TECHNIQUE(test_spotlight, GATHER),      OF_TECHNIQUE(test_narrow_beam, BACKWARD),
        OF_TECHNIQUE(test_narrow_beam, GATHER),    OF_TECHNIQUE(test_narrow_beam, DIRECT),
        OF_TECHNIQUE(test_many_lamps, BACKWARD),   OF_TECHNIQUE(test_many_lamps, GATHER),
        OF_TECHNIQUE(test_through_pane, BACKWARD), OF_TECHNIQUE(test_through_pane, GATHER),
        cmocka_unit_test(test_facing_mirrors),     cmocka_unit_test(test_facing_mirrors_by_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
