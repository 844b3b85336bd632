/*
 * Polygons as strangers write them, in whole jobs: walls whose window is a hole, wound either way,
 * or cut out by a seam that the outline walks elsewhere. A ray knows inside from outside by the
 * number of edges that it crosses; so must all that is made of the outline.
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
    /* the hole the other way round than the outline, and the same way */
    "w polygon s 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n",
    "w polygon s 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 1 0 2.5 3 0 2.5 3 0 1 1 0 1\n",
    /* the seam from another corner, with a corner on it; repeated corners, and a spike */
    "w polygon s 0 0 45 0 0 0 0 0 3 0 0 3 4 0 3 3.5 0 2.75 3 0 2.5 3 0 1 1 0 1 1 0 2.5 3 0 2.5 "
    "3.5 0 2.75 4 0 3 4 0 0 4 0 -1 4 0 0\n",
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

/* The wall is the same but for how its border is walked: so is the light, to the last bit. */
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

/* The triangles differ, and with them what is drawn: the same within the noise of 256 rays. */
static void test_seams_and_islands(void **state)
{
    double expected[ROOM_SENSORS], lx[ROOM_SENSORS];
    (void)state;
    light_of(walls[0], ORL_TECHNIQUE_BACKWARD, expected);
    light_of(walls[2], ORL_TECHNIQUE_BACKWARD, lx);
    for (int i = 0; i < ROOM_SENSORS; i++)
        assert_true(fabs(lx[i] - expected[i]) <= 0.03 * expected[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_either_winding),
        cmocka_unit_test(test_seams_and_islands),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
