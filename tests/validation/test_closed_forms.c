/*
 * Illuminances with known values, computed through orl_run: skies, windows, the sun, an integrating
 * sphere, a furnace of glass, Lambertian panes.
 *
 * Photometry: a radiance of 1 in every channel is 179 lm/W. Seeds are fixed. Tolerances are three
 * standard errors of the random part, plus the error of the closed form, stated at each test.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "photon/map/map.h"
#include "support/cli.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
#define SPHERE_SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
/* CIE overcast of zenith radiance 1; its ground value continues the horizon's. */
#define OVERCAST                                                                                   \
    "void brightfunc f 2 skybright skybright.cal 0 3 2 1 .33333333\n"                              \
    "f glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
/* From the south at an altitude of 45 degrees: also 45 degrees to a southern window. */
#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"

#define BLACK "void plastic w 0 0 5 0 0 0 0 0\n"

/* A room of 4 x 5 x 3 m whose southern wall (y = 0) has a hole of 2 x 1.5 m from z = 1. */
#define ROOM_AROUND_A_HOLE                                                                         \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"                                           \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"                                             \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"
/* Fills the hole; faces the room. */
#define PANE "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"

static const double efficacy = ORL_EFFICACY_LM_PER_W;

static double sun_normal_lx(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return efficacy * 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

static void assert_within(double value, double expected, double relative)
{
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.6g is not within %.2g of %.6g", value, relative, expected);
}

/*
 * ---- Skies ------------------------------------------------------------------------------------
 */

/* A stratified hemisphere of 4096 rays: a smooth integrand has an error of 1e-3, an edge of the sky
 * 1/4096^.75. */
static void test_open_sky(void **state)
{
    static const struct orl_sensor sensors[4] = {{{0, 0, 1}, {0, 0, 1}},
                                                 {{5, 5, 1}, {0, -1, 0}},
                                                 {{0, 0, 1}, {3, 4, 0}},
                                                 {{0, 0, 1}, {0, 0, -1}}};
    double lx[4];
    (void)state;
    scene_run_lx(&(struct scene_run){.scene = SKY, .sensors = sensors, .n_sensors = 4}, lx);
    assert_within(lx[0], efficacy * ORL_PI, 2e-3);
    assert_within(lx[1], efficacy * ORL_PI / 2, 4e-3);
    assert_within(lx[2], efficacy * ORL_PI / 2, 4e-3);
    assert_true(lx[3] == 0);
}

/*
 * 7 pi Lz / 9, and 0.396177 of it on a wall. Radiance's formula blends into the ground near the
 * horizon, which changes the vertical value by some tenths of a percent.
 */
static void test_overcast_sky(void **state)
{
    static const struct orl_sensor sensors[2] = {{{0, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}}};
    double lx[2];
    (void)state;
    scene_run_lx(&(struct scene_run){.scene = OVERCAST, .sensors = sensors, .n_sensors = 2}, lx);
    assert_within(lx[0], efficacy * 7 * ORL_PI / 9, 3e-3);
    assert_within(lx[1] / lx[0], 0.396177, 8e-3);
}

/*
 * Sky component through an unglazed window of 2 x 1.5 m, 2 m away, at the sill and one jamb. It
 * fills 4 % of the hemisphere, 2600 of the 65536 rays, which are stratified, so that only its edges
 * are noisy.
 */
static void test_sky_component(void **state)
{
    static const struct orl_sensor sensor = {{1, 2, 1}, {0, 0, 1}};
    double lx;
    (void)state;
    const struct scene_run uniform = {.scene = SKY BLACK ROOM_AROUND_A_HOLE,
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .samples = 65536};
    scene_run_lx(&uniform, &lx);
    assert_within(lx, 0.039089 * efficacy * ORL_PI, 0.01);
    struct scene_run overcast = uniform;
    overcast.scene = OVERCAST BLACK ROOM_AROUND_A_HOLE;
    scene_run_lx(&overcast, &lx);
    assert_within(lx, 0.029330 * efficacy * 7 * ORL_PI / 9, 0.01);
}

/*
 * ---- The sun ----------------------------------------------------------------------------------
 */

/* E = DNI tau cos in the patch, tau of a lossless pane at 45 degrees; zero beside it. */
static void test_sun_patch(void **state)
{
    /* The patch is the window moved by (0, z, -z): y from 1 to 2.5. */
    static const struct orl_sensor sensors[4] = {{{2, 1.75, 0}, {0, 0, 1}},
                                                 {{1.1, 1.1, 0}, {0, 0, 1}},
                                                 {{2, 2.6, 0}, {0, 0, 1}},
                                                 {{2, 1, 1}, {0, -1, 1}}};
    double lx[4];
    (void)state;
    scene_run_lx(
        &(struct scene_run){.scene =
                                SUN "void glass p 0 0 4 1 1 1 1.52\n" BLACK ROOM_AROUND_A_HOLE PANE,
                            .sensors = sensors,
                            .n_sensors = 4,
                            .caustic = 1000},
        lx);
    /* The disc is half a degree wide: cosines over it average to the centre's within 1e-5. */
    assert_within(lx[0], sun_normal_lx() * 0.902528 * sqrt(0.5), 1e-4);
    assert_within(lx[1], sun_normal_lx() * 0.902528 * sqrt(0.5), 1e-4);
    assert_true(lx[2] == 0);
    assert_within(lx[3], sun_normal_lx() * 0.902528, 1e-4);
}

/*
 * A blade a metre above a sensor halves the sun's disc, 9 mm wide there, over a slope as wide as a
 * town. The offset for that wide slope must not lift other sensors out of the shadow's edge (to
 * 0.39 of the sun) or through a shelf half a millimetre above. Sensors on the slope see all of the
 * sun.
 */
static void test_edge_of_a_shadow_in_a_wide_scene(void **state)
{
    static const char scene[] =
        "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 0 1 .533\n" BLACK
        "w polygon blade 0 0 12 0 -1 1 2 -1 1 2 1 1 0 1 1\n"
        "w polygon slope 0 0 12 -200 -200 -61 200 -200 -21 "
        "200 200 59 -200 200 19\n";
    static const struct orl_sensor sensors[5] = {{{0, 0, 0}, {0.8, 0, 0.6}},
                                                 {{1, 0, 0.9995}, {0, 0, 1}},
                                                 {{7.3, -4.1, -1.09}, {0, 0, 1}},
                                                 {{-150, 30, -10}, {0, 0, 1}},
                                                 {{180, -33.7, 10.26}, {-0.1, -0.2, 1}}};
    (void)state;
    for (int backward = 0; backward < 2; backward++) {
        double lx[5];
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = sensors,
                                         .n_sensors = 5,
                                         .technique = backward ? ORL_TECHNIQUE_BACKWARD
                                                               : ORL_TECHNIQUE_GATHER,
                                         .samples = 4096},
                     lx);
        /* At least 256 stratified rays per edge: 256^-.75. */
        assert_within(lx[0], 0.5 * 0.6 * sun_normal_lx(), 0.016);
        assert_true(lx[1] == 0);
        assert_within(lx[2], sun_normal_lx(), 1e-4);
        assert_within(lx[3], sun_normal_lx(), 1e-4);
        assert_within(lx[4], sun_normal_lx() / sqrt(1.05), 1e-4);
    }
}

/* Sensors on the roof, in front of the window, and inside, of a sealed room. */
static void test_inside_and_outside(void **state)
{
    static const struct orl_sensor sensors[3] = {
        {{2, 2.5, 3.001}, {0, 0, 1}}, {{2, -1, 1.5}, {0, -1, 0}}, {{2, 4, 1}, {0, 1, 0}}};
    double lx[3];
    (void)state;
    scene_run_lx(
        &(struct scene_run){.scene = SKY SUN
                            "void glass p 0 0 4 1 1 1 1.52\n" BLACK ROOM_AROUND_A_HOLE PANE,
                            .sensors = sensors,
                            .n_sensors = 3},
        lx);
    assert_within(lx[0], efficacy * ORL_PI + sun_normal_lx() * sqrt(0.5), 2e-3);
    assert_within(lx[1], efficacy * ORL_PI / 2 + sun_normal_lx() * sqrt(0.5), 4e-3);
    assert_true(lx[2] == 0);
}

/*
 * A room without a window, lit outside, is dark inside. A scene without any light ends after some
 * batches of paths, not after the requested millions, with a warning.
 */
static void test_room_without_window(void **state)
{
    static const struct orl_sensor sensors[2] = {{{1, 1, 1}, {0, 0, 1}}, {{1, 1, 0}, {0, 0, 1}}};
    struct scene_run run = {.scene = SKY SUN
                            "void plastic w 0 0 5 .5 .5 .5 0 0\n!genbox w room 4 5 3 -i\n",
                            .sensors = sensors,
                            .n_sensors = 2,
                            .caustic = 20000};
    double lx[2];
    bool told = false;
    (void)state;
    scene_run_lx(&run, lx);
    assert_true(lx[0] == 0 && lx[1] == 0);
    run.scene = "void plastic w 0 0 5 .5 .5 .5 0 0\n!genbox w room 4 5 3 -i\n";
    run.global = run.caustic = 1000000;
    run.overrides = scene_wish_maps;
    struct orl_result result = scene_run(&run);
    for (size_t i = 0; i < result.n_warnings; i++)
        told = told || strstr(result.warnings[i], "no light");
    assert_true(told);
    assert_true(result.illuminance_lx[0] == 0 && result.illuminance_lx[1] == 0);
    assert_int_equal(result.maps[0].stored, 0);
    assert_true(result.maps[0].emitted <= 1000000 && result.maps[1].emitted <= 1000000);
    orl_result_done(&result);
}

/*
 * ---- Interreflection --------------------------------------------------------------------------
 */

/* Exporters round: a wall whose corners differ by 0.03 mm, and so are not coplanar, is as tight. */
static void test_room_of_rounded_numbers(void **state)
{
    static const char scene[] =
        SKY SUN "void plastic w 0 0 5 .7 .7 .7 0 0\n"
                "w polygon floor 0 0 12 0 0 0 8 0 0 8 4.0731 0 0 4.073073 0\n"
                "w polygon roof 0 0 12 0 0 3 0 4.0731 3 8 4.073073 3 8 0 3\n"
                "w polygon west 0 0 12 0 0 0 0 4.073073 0 0 4.0731 3 0 0 3\n"
                "w polygon east 0 0 12 8 0 0 8 0 3 8 4.073073 3 8 4.0731 0\n"
                "w polygon south 0 0 12 0 0 0 0 0 3 8 0 3 8 0 0\n"
                "w polygon north 0 0 12 8 4.0731 0 8 4.073073 3 0 4.0731 3 0 4.073073 0\n";
    static const struct orl_sensor sensors[2] = {{{4, 3, 1.5}, {0, 1, 0}},
                                                 {{2, 1, 0.8}, {0, 0, 1}}};
    (void)state;
    for (int backward = 0; backward < 2; backward++) {
        double lx[2];
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = sensors,
                                         .n_sensors = 2,
                                         .technique = backward ? ORL_TECHNIQUE_BACKWARD
                                                               : ORL_TECHNIQUE_GATHER,
                                         .samples = 4096},
                     lx);
        assert_true(lx[0] == 0 && lx[1] == 0);
    }
}

/*
 * A lamp of radius a in a sphere of radius 1: E_direct = pi L a^2, and a share a^2 of the light
 * that the wall reflects hits the lamp and is lost: E = E_direct / (1 - rho (1 - a^2)). The number
 * of landings of a path is geometric, with relative variance rho. A sensor's 4096 rays each read an
 * estimate of variance 1/62 (k = 64), and those of neighbouring leaves share three quarters of
 * their photons.
 */
static void test_integrating_sphere(void **state)
{
    static const double reflectances[3] = {0.2, 0.5, 0.9};
    static const struct orl_sensor sensors[3] = {
        {{0, 0, -1}, {0, 0, 1}}, {{1, 0, 0}, {-1, 0, 0}}, {{0, -.6, .8}, {0, .6, -.8}}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double rho = reflectances[i], a = 0.1;
        const double direct = efficacy * ORL_PI * 100 * a * a;
        const double total = direct / (1 - rho * (1 - a * a));
        char scene[512];
        snprintf(scene, sizeof scene,
                 "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
                 "void plastic w 0 0 5 %g %g %g 0 0\nw bubble wall 0 0 4 0 0 0 1\n",
                 rho, rho, rho);
        struct orl_result result = scene_run(&(struct scene_run){
            .scene = scene, .sensors = sensors, .n_sensors = 3, .global = 300000});
        const double leaves = (double)result.maps[0].stored / 16;
        const double sigma =
            sqrt(rho / (double)result.maps[0].emitted + (1.0 / 4096 + 4 / leaves) / 62);
        for (int k = 0; k < 3; k++) {
            const double indirect = result.illuminance_lx[k] - direct;
            assert_within(indirect, total - direct, 3 * sigma);
        }
        orl_result_done(&result);
    }
}

/*
 * A furnace: inside a box of lossless glass under a uniform sky all around, every direction has
 * radiance 1, straight or mirrored any number of times. A sensor beside a dark ball sees radiance 1
 * except the ball; on the ball's own surface nothing is in the way.
 */
static void test_glass_furnace(void **state)
{
    static const char scene[] = SPHERE_SKY "void glass p 0 0 4 1 1 1 1.52\n!genbox p box 2 2 2\n"
                                           "void plastic b 0 0 5 .1 .1 .1 0 0\n"
                                           "b sphere ball 0 0 4 1 1 1 .05\n";
    static const struct orl_sensor sensors[3] = {
        {{1, 1, 1.05}, {0, 0, 1}}, {{.3, .4, .2}, {0, 0, -1}}, {{1.9, 1.9, 1.9}, {1, 1, 1}}};
    double lx[3];
    (void)state;
    scene_run_lx(
        &(struct scene_run){.scene = scene, .sensors = sensors, .n_sensors = 3, .global = 200}, lx);
    /* Mirrored rays that hit the ball: less than 0.5 % of a hemisphere, times their share. */
    for (int i = 0; i < 3; i++)
        assert_within(lx[i], efficacy * ORL_PI, 0.005);
}

/*
 * Glass of refractive index 1 without absorption is invisible: the light of its port must equal
 * that of the open hole, although photons start in another way. With a million photons each, single
 * sensors scattered by 0.9 % over seeds, so 3 sigma of a difference are 4 %.
 */
static void test_hole_and_invisible_pane(void **state)
{
    static const struct orl_sensor sensors[4] = {{{1, 2, 0}, {0, 0, 1}},
                                                 {{2, 4, 0}, {0, 0, 1}},
                                                 {{2, 3, 3}, {0, 0, -1}},
                                                 {{2, 4, 1.5}, {0, 1, 0}}};
    double hole[4], pane[4];
    (void)state;
    struct scene_run run = {.scene =
                                SKY SUN "void plastic w 0 0 5 .5 .5 .5 0 0\n" ROOM_AROUND_A_HOLE,
                            .sensors = sensors,
                            .n_sensors = 4,
                            .global = 1000000};
    scene_run_lx(&run, hole);
    run.scene = SKY SUN
        "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 4 1 1 1 1\n" ROOM_AROUND_A_HOLE PANE;
    scene_run_lx(&run, pane);
    for (int i = 0; i < 4; i++) {
        assert_within(pane[i], hole[i], 0.04);
    }
}

/*
 * Distant lamps: radiance times the visible area, over the distance squared. At 5 m a tube of 35 cm
 * is .1 % further away; 4096 stratified samples have an error of .05 %. The difficulty is the
 * distance: rays are floats, and near the rim of a round lamp must not count as hitting it too soon
 * (three rays in four did for a tube at 30 m).
 */
static void test_lamps_of_any_shape(void **state)
{
    static const struct {
        const char *lamp;
        double area; /* visible area along x, m2 */
    } lamps[] = {{"l sphere s 0 0 4 0 0 0 .06\n", ORL_PI * .06 * .06},
                 {"l cylinder c 0 0 7 0 0 .175 0 0 -.175 .06\n", .35 * .12},
                 {"l cone c 0 0 8 0 0 .175 0 0 -.175 .06 .03\n", .35 * .09},
                 {"l ring d 0 0 8 0 0 0 1 0 0 0 .06\n", ORL_PI * .06 * .06}};
    static const double distances[] = {30, 300, 3000};
    (void)state;
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++)
        for (int k = 0; k < 3; k++) {
            const double d = distances[k];
            const struct orl_sensor sensor = {{d, 0, 0}, {-1, 0, 0}};
            char scene[256];
            double lx;
            snprintf(scene, sizeof scene, "void light l 0 0 3 100 100 100\n%s", lamps[i].lamp);
            scene_run_lx(&(struct scene_run){.scene = scene,
                                             .sensors = &sensor,
                                             .n_sensors = 1,
                                             .technique = ORL_TECHNIQUE_BACKWARD,
                                             .samples = 4096},
                         &lx);
            assert_within(lx, efficacy * 100 * lamps[i].area / (d * d), .004);
        }
}

/* A free sensor has the same value as one on a small plate in its place. */
static void test_mid_air(void **state)
{
    static const struct orl_sensor sensor = {{2, 3, 1}, {0, 0, 1}};
    double air, plate;
    (void)state;
    struct scene_run run = {.scene = SKY SUN
                            "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 .8 .8 "
                            ".8\n" ROOM_AROUND_A_HOLE PANE,
                            .sensors = &sensor,
                            .n_sensors = 1,
                            .global = 200000};
    scene_run_lx(&run, &air);
    run.scene = SKY SUN
        "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 .8 .8 .8\n" ROOM_AROUND_A_HOLE PANE
        "w polygon plate 0 0 12 1.99 2.99 1 2.01 2.99 1 2.01 3.01 1 1.99 3.01 1\n";
    scene_run_lx(&run, &plate);
    assert_within(plate, air, 0.02);
}

/*
 * Above a wide scene with few photons, a sensor sees only the sky: 5 m above ground that is in the
 * shade of a roof, except a hole right under the sensor. The rays' error of the sky's light is
 * below 1 %; the ground's light would be a third.
 */
static void test_high_above_the_ground(void **state)
{
    static const char scene[] =
        "void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 180\n"
        "void plastic ground 0 0 5 .5 .5 .5 .05 .2\n"
        "ground polygon g 0 0 12 -300 -300 0 300 -300 0 300 300 0 -300 300 0\n"
        "void plastic tin 0 0 5 .3 .3 .3 .1 .1\n"
        "tin polygon roof 0 0 30 -40 -40 3 40 -40 3 40 40 3 -40 40 3 -40 -40 3 -.5 -.5 3 "
        "-.5 .5 3 .5 .5 3 .5 -.5 3 -.5 -.5 3\n";
    static const struct orl_sensor sensor = {{0, 0, 5}, {0, 0, 1}};
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_DIRECT};
    (void)state;
    for (size_t i = 0; i < sizeof techniques / sizeof *techniques; i++) {
        double lx;
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .technique = techniques[i],
                                         .overrides = scene_wish_maps,
                                         .global = 2000,
                                         .caustic = 500},
                     &lx);
        print_message("%s: %.1f lx\n", orl_technique_name(techniques[i]), lx);
        assert_within(lx, efficacy * ORL_PI, 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_sky),
        cmocka_unit_test(test_overcast_sky),
        cmocka_unit_test(test_sky_component),
        cmocka_unit_test(test_sun_patch),
        cmocka_unit_test(test_edge_of_a_shadow_in_a_wide_scene),
        cmocka_unit_test(test_inside_and_outside),
        cmocka_unit_test(test_room_without_window),
        cmocka_unit_test(test_room_of_rounded_numbers),
        cmocka_unit_test(test_integrating_sphere),
        cmocka_unit_test(test_glass_furnace),
        cmocka_unit_test(test_hole_and_invisible_pane),
        cmocka_unit_test(test_lamps_of_any_shape),
        cmocka_unit_test(test_mid_air),
        cmocka_unit_test(test_high_above_the_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
