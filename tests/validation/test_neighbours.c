/*
 * Light from behind the windows of other buildings, in sealed scenes, where paths leave by one
 * window and enter by another. Compared with a closed form, and with the same scene with an open
 * slit, which is computed in another way.
 *
 * A glass facade is two millimetres in front of a wall of reflectance a half, under a uniform sky
 * all around. With interreflection between the two, the wall's radiosity is rho T E / (1 - rho R),
 * T and R the pane's for diffuse light, E the sky's.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/scene_text.h"

static const struct orl_hit anywhere = {.normal = {0, 0, 1}, .front = true};

#define SKY "void glow d 0 0 4 10 10 10 0\nd source sky 0 0 4 0 0 1 360\n"
#define FACADE                                                                                     \
    "void glass g 0 0 3 .763 .763 .763\nvoid plastic w 0 0 5 .5 .5 .5 0 0\n"                       \
    "w polygon back 0 0 12 -3 6.002 0 3 6.002 0 3 6.002 5 -3 6.002 5\n"                            \
    "g polygon front 0 0 12 -3 6 0 3 6 0 3 6 5 -3 6 5\n"                                           \
    "w polygon west 0 0 12 -3 6 0 -3 6.002 0 -3 6.002 5 -3 6 5\n"                                  \
    "w polygon east 0 0 12 3 6 0 3 6.002 0 3 6.002 5 3 6 5\n"                                      \
    "w polygon below 0 0 12 -3 6 0 3 6 0 3 6.002 0 -3 6.002 0\n"
#define ABOVE "w polygon above 0 0 12 -3 6 5 3 6 5 3 6.002 5 -3 6.002 5\n"
#define ROOM                                                                                       \
    "g polygon window 0 0 12 -2 0 0 2 0 0 2 0 3 -2 0 3\n"                                          \
    "w polygon floor 0 0 12 -2 0 0 -2 -4 0 2 -4 0 2 0 0\n"                                         \
    "w polygon ceiling 0 0 12 -2 0 3 2 0 3 2 -4 3 -2 -4 3\n"                                       \
    "w polygon w 0 0 12 -2 0 0 -2 0 3 -2 -4 3 -2 -4 0\n"                                           \
    "w polygon e 0 0 12 2 0 0 2 -4 0 2 -4 3 2 0 3\n"                                               \
    "w polygon s 0 0 12 -2 -4 0 -2 -4 3 2 -4 3 2 -4 0\n"

/* Returns the hemispherical mean for uniform light on one side of a pane. */
static double diffuse(const struct orl_material *glass,
                      struct orl_rgb (*share)(const struct orl_material *, const struct orl_hit *,
                                              double))
{
    enum { STEPS = 1000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        sum += share(glass, &anywhere, sqrt((i + 0.5) / STEPS)).g / STEPS;
    return sum;
}

/* A sensor at (0, 3, 1) that faces the facade: the sky, and the facade's light in place of the sky
 * that it hides. */
static double before_the_facade(void)
{
    enum { SIDE = 600 };
    struct orl_parsed_scene d = scene_parse_text(SKY FACADE, NULL, NULL);
    const struct orl_material *glass = &d.materials[d.surfaces[1].material];
    const double t = diffuse(glass, orl_glass_transmittance);
    const double r = diffuse(glass, orl_glass_reflectance);
    const double wall = 10 * 0.5 * t / (1 - 0.5 * r);
    double sum = 10 * ORL_PI;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = -3 + 6 * (i % SIDE + 0.5) / SIDE, z = -1 + 5 * (i / SIDE + 0.5) / SIDE;
        const double d2 = x * x + 9 + z * z, cosine = 3 / sqrt(d2);
        const double seen = orl_glass_reflectance(glass, &anywhere, cosine).g * 10 +
                            orl_glass_transmittance(glass, &anywhere, cosine).g * wall;
        sum += (seen - 10) * cosine * cosine / d2 * 30 / (SIDE * SIDE);
    }
    orl_parsed_scene_done(&d);
    return ORL_EFFICACY_LM_PER_W * sum;
}

static struct orl_result run_scene(const char *scene, const struct orl_sensor *sensor,
                                   enum orl_technique technique)
{
    return scene_run(&(struct scene_run){.scene = scene,
                                         .sensors = sensor,
                                         .n_sensors = 1,
                                         .technique = technique,
                                         .samples = 4096,
                                         .global = 100000});
}

/* Four of its own standard errors, and the loss at the slit's edges, a thousandth. */
static void sees_the_wall_behind(void **state)
{
    static const struct orl_sensor sensor = {{0, 3, 1}, {0, 1, 0}};
    static const enum orl_technique techniques[2] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    const double expected = before_the_facade();
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct orl_result r = run_scene(SKY FACADE ABOVE, &sensor, techniques[i]);
        const double lx = r.illuminance_lx[0], error = r.standard_error_lx[0];
        if (!(error < 0.01 * expected) || !(fabs(lx - expected) < 4 * error + 1e-3 * expected))
            fail_msg("technique %d: %g +- %g lx, not %g", i, lx, error, expected);
        orl_result_done(&r);
    }
}

/* From within a room, through window and facade: sealed or open, the light is equal. */
static void a_slit_changes_nothing(void **state)
{
    static const struct orl_sensor sensor = {{0, -1, 1.2}, {0, 1, 0}};
    static const enum orl_technique techniques[2] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct orl_result sealed = run_scene(SKY FACADE ABOVE ROOM, &sensor, techniques[i]);
        struct orl_result open = run_scene(SKY FACADE ROOM, &sensor, techniques[i]);
        const double a = sealed.illuminance_lx[0], b = open.illuminance_lx[0];
        const double error = hypot(sealed.standard_error_lx[0], open.standard_error_lx[0]);
        if (!(error < 0.01 * a) || !(fabs(a - b) < 4 * error + 1e-3 * a))
            fail_msg("technique %d: sealed %g, open %g, +- %g", i, a, b, error);
        orl_result_done(&sealed);
        orl_result_done(&open);
    }
}

/* ---- Virtual lamps right behind panes -------------------------------------------------------- */

#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
#define DIM_WALL                                                                                   \
    "void glass g 0 0 3 .763 .763 .763\nvoid plastic w 0 0 5 .05 .05 .05 0 0\n"                    \
    "w polygon back 0 0 12 -3 6.01 0 3 6.01 0 3 6.01 5 -3 6.01 5\n"                                \
    "g polygon front 0 0 12 -3 6 0 3 6 0 3 6 5 -3 6 5\n"                                           \
    "g polygon near 0 0 12 -1 0 -1 1 0 -1 1 0 1.5 -1 0 1.5\n"                                      \
    "w polygon far 0 0 12 40 -40 -9 41 -40 -9 41 -40 -8 40 -40 -8\n"

/* A sunlit wall seen from 6.71 m away through two panes; no virtual sun reaches the sensor. */
static double through_two_panes(void)
{
    enum { SIDE = 400 };
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD, rho = 0.05;
    const double sun = 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half) * sqrt(0.5);
    struct orl_parsed_scene d = scene_parse_text(SUN DIM_WALL, NULL, NULL);
    const struct orl_material *glass = &d.materials[d.surfaces[1].material];
    const double wall = sun * orl_glass_transmittance(glass, &anywhere, sqrt(0.5)).g * rho /
                        ORL_PI / (1 - rho * diffuse(glass, orl_glass_reflectance));
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = -3 + 6 * (i % SIDE + 0.5) / SIDE, z = -1 + 5 * (i / SIDE + 0.5) / SIDE;
        const double d2 = x * x + 6.71 * 6.71 + z * z, cosine = 6.71 / sqrt(d2);
        const double through = orl_glass_transmittance(glass, &anywhere, cosine).g;
        sum += wall * through * through * cosine * cosine / d2 * 30 / (SIDE * SIDE);
    }
    orl_parsed_scene_done(&d);
    return ORL_EFFICACY_LM_PER_W * sum;
}

/* Rays to virtual lamps close to their surface restart a little behind every pane: they must not
 * end behind the lamps. Four standard errors, and the light through the edges of the slit. */
static void lamps_shine_through_panes(void **state)
{
    static const struct orl_sensor sensor = {{0, -0.7, 1}, {0, 1, 0}};
    const double expected = through_two_panes();
    struct orl_result r = run_scene(SUN DIM_WALL, &sensor, ORL_TECHNIQUE_BACKWARD);
    const double lx = r.illuminance_lx[0], error = r.standard_error_lx[0];
    (void)state;
    if (!(error < 0.01 * expected) || !(fabs(lx - expected) < 4 * error + 3e-3 * expected))
        fail_msg("%g +- %g lx, not %g", lx, error, expected);
    orl_result_done(&r);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(sees_the_wall_behind),
        cmocka_unit_test(a_slit_changes_nothing),
        cmocka_unit_test(lamps_shine_through_panes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
