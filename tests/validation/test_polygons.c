/*
 * Unusual polygons in whole jobs: walls whose window is a hole, with either winding, or cut out by
 * a seam elsewhere in the outline; and two coincident polygons, of which Radiance's rule selects
 * the visible one. A ray's parity of crossed edges separates inside from outside; all structures
 * derived from the outline must agree.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/room.h"

#define BOX                                                                                        \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"                                           \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
#define LIGHTS ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR

/* The southern wall around the window of ROOM_PANE. */
static const char *const walls[] = {
    /* the hole with the opposite winding of the outline, and with the same */
    "w polygon s 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n",
    "w polygon s 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 1 0 2.5 3 0 2.5 3 0 1 1 0 1\n",
    /* the seam from another corner, with a corner on it; repeated corners, and a spike */
    ("w polygon s 0 0 45 0 0 0 0 0 3 0 0 3 4 0 3 3.5 0 2.75 3 0 2.5 3 0 1 1 0 1 1 0 2.5 3 0 2.5 "
     "3.5 0 2.75 4 0 3 4 0 0 4 0 -1 4 0 0\n"),
};

static void light_of(const char *wall, enum orl_technique technique, double ret_lx[ROOM_SENSORS])
{
    char scene[4096];
    snprintf(scene, sizeof scene, "%s%s%s%s", LIGHTS, BOX, wall, ROOM_PANE);
    scene_run_lx(&(struct scene_run){.scene = scene,
                                     .technique = technique,
                                     .sensors = room_sensors,
                                     .n_sensors = ROOM_SENSORS,
                                     .samples = 256},
                 ret_lx);
}

/* The walls differ only in the order of their border: the light is equal to the last bit. */
static void test_either_winding(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_BACKWARD};
    (void)state;
    for (int t = 0; t < 2; t++) {
        double expected[ROOM_SENSORS], lx[ROOM_SENSORS];
        light_of(walls[0], techniques[t], expected);
        assert_true(expected[0] > 100);
        light_of(walls[1], techniques[t], lx);
        assert_memory_equal(lx, expected, sizeof lx);
    }
}

/*
 * The triangles differ, and with them the samples: results are equal within the noise of 256 rays.
 */
static void test_other_seams(void **state)
{
    double expected[ROOM_SENSORS], lx[ROOM_SENSORS];
    (void)state;
    light_of(walls[0], ORL_TECHNIQUE_BACKWARD, expected);
    light_of(walls[2], ORL_TECHNIQUE_BACKWARD, lx);
    for (int i = 0; i < ROOM_SENSORS; i++)
        assert_true(fabs(lx[i] - expected[i]) <= 0.03 * expected[i]);
}

/* ---- Coincident polygons --------------------------------------------------------------------- */

#define SKY_AND_PAINTS(first, second) ROOM_SKY "void plastic " first "\nvoid plastic " second "\n"
#define WHITE "white 0 0 5 .8 .8 .8 0 0"
#define GREY "grey 0 0 5 .2 .2 .2 0 0"
#define FLOOR "white polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n"
#define GROUND "grey polygon ground 0 0 12 -10 -10 0 10 -10 0 10 10 0 -10 10 0\n"

static void look_down(const char *scene, enum orl_technique technique, double ret_lx[2])
{
    static const struct orl_sensor sensors[2] = {{{0, 0, 1}, {0, 0, -1}}, {{5, 5, 1}, {0, 0, -1}}};
    scene_run_lx(&(struct scene_run){.scene = scene,
                                     .technique = technique,
                                     .sensors = sensors,
                                     .n_sensors = 2,
                                     .global = 200000,
                                     .samples = 2048},
                 ret_lx);
}

/*
 * A floor in its ground's plane. Seen from one metre above, a square of half side a takes 4/pi s
 * atan(s) of the view down, s = a / sqrt(1 + a^2); all of it is lit by pi. The material defined
 * later is on top, whichever polygon is written first. 2048 rays of a low-discrepancy sequence: 1
 * %; photons, 8000 of them on the floor, are accurate to 3 % including the bias of their estimate.
 */
static double share_of_square(double half)
{
    const double slope = half / sqrt(1 + half * half);
    return 4 * 2 / (2 * ORL_PI) * slope * atan(slope);
}

static void test_floor_in_ground(void **state)
{
    const double lit = ORL_EFFICACY_LM_PER_W * ORL_PI;
    const double inner = share_of_square(2), outer = share_of_square(10);
    const double on_floor = lit * (inner * .8 + (outer - inner) * .2), on_ground = lit * outer * .2;
    double lx[4][2];
    (void)state;
    look_down(SKY_AND_PAINTS(GREY, WHITE) FLOOR GROUND, ORL_TECHNIQUE_BACKWARD, lx[0]);
    look_down(SKY_AND_PAINTS(GREY, WHITE) GROUND FLOOR, ORL_TECHNIQUE_BACKWARD, lx[1]);
    for (int i = 0; i < 2; i++)
        assert_true(fabs(lx[i][0] - on_floor) <= 0.01 * on_floor);
    look_down(SKY_AND_PAINTS(WHITE, GREY) FLOOR GROUND, ORL_TECHNIQUE_BACKWARD, lx[2]);
    look_down(SKY_AND_PAINTS(WHITE, GREY) GROUND, ORL_TECHNIQUE_BACKWARD, lx[3]);
    assert_true(fabs(lx[2][0] - on_ground) <= 0.01 * on_ground);
    assert_memory_equal(lx[2], lx[3], sizeof lx[2]);
    look_down(SKY_AND_PAINTS(GREY, WHITE) FLOOR GROUND, ORL_TECHNIQUE_GATHER, lx[0]);
    assert_true(fabs(lx[0][0] - on_floor) <= 0.03 * on_floor);
}

/* A pane on a wall without a hole is dark; an opaque patch on it shows the patch. */
static void test_panes_on_walls(void **state)
{
    double lx[ROOM_SENSORS], patched[ROOM_SENSORS], holed[ROOM_SENSORS];
    (void)state;
    light_of("w polygon s 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n", ORL_TECHNIQUE_BACKWARD, lx);
    for (int i = 0; i < ROOM_SENSORS; i++)
        assert_true(lx[i] == 0);
    char scene[2048];
    snprintf(scene, sizeof scene, "%sw polygon patch 0 0 12 1 0 1 2 0 1 2 0 2.5 1 0 2.5\n",
             walls[0]);
    light_of(scene, ORL_TECHNIQUE_BACKWARD, patched);
    light_of("w polygon s 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 2 0 1 3 0 1 3 0 2.5 2 0 2.5 2 0 1\n",
             ORL_TECHNIQUE_BACKWARD, holed);
    for (int i = 0; i < ROOM_SENSORS; i++)
        assert_true(fabs(patched[i] - holed[i]) <= 0.05 * holed[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_either_winding),
        cmocka_unit_test(test_other_seams),
        cmocka_unit_test(test_floor_in_ground),
        cmocka_unit_test(test_panes_on_walls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
