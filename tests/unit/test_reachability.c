/*
 * Reachability of places by light: through a hole of any size, from a lamp of any size, through
 * glass; not into closed rooms and solids, and not without a light. Equal for any number of
 * threads.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "light/enclosures.h"
#include "support/room.h"

#define CLOSED ROOM_SKY ROOM_SUN ROOM_GREY "!genbox w room 4 5 3 -i\n"
#define LAMP "void light lamp 0 0 3 1 1 1\n"

/* Tests all directions from one place in the files' coordinates. */
static bool reaches(const char *text, struct orl_vec3 from, uint32_t threads)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(threads);
    struct orl_lit_scene *lit_scene = build_lit_scene(text, NULL, NULL, pool);
    const struct orl_query_point query_point = {orl_sub(from, lit_scene->geometry->center),
                                                {0, 0, 0}};
    const bool found = orl_light_reaches(lit_scene, &query_point, 1, 16384, pool);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
    return found;
}

static void test_closed(void **state)
{
    (void)state;
    for (uint32_t threads = 1; threads <= 3; threads += 2) {
        assert_false(reaches(CLOSED, orl_v3(1, 1, 1), threads));
        assert_true(reaches(CLOSED, orl_v3(9, 9, 9), threads));
        assert_false(
            reaches(CLOSED LAMP "lamp sphere bulb 0 0 4 5 1 1 .1\n", orl_v3(1, 1, 1), threads));
    }
}

/* A hole of 2 x 2 cm is 4e-6 of the room's surface. */
static void test_hole(void **state)
{
    static const char text[] =
        ROOM_SKY ROOM_GREY "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
                           "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
                           "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
                           "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
                           "w polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"
                           "w polygon ceiling 0 0 30 0 0 3 0 5 3 4 5 3 4 0 3 0 0 3 "
                           "2 2 3 2.02 2 3 2.02 2.02 3 2 2.02 3 2 2 3\n";
    (void)state;
    assert_true(reaches(text, orl_v3(1, 1, 1), 1));
}

static void test_lamps(void **state)
{
    static const char small[] = CLOSED LAMP "lamp sphere bulb 0 0 4 3 4 2 1e-5\n";
    static const char encased[] = CLOSED LAMP "lamp sphere bulb 0 0 4 3 4 2 1e-5\n"
                                              "void glass p 0 0 3 .9 .9 .9\n"
                                              "p sphere case 0 0 4 3 4 2 .1\n";
    static const char hidden[] = CLOSED LAMP "lamp sphere bulb 0 0 4 3 4 2 1e-5\n"
                                             "w sphere case 0 0 4 3 4 2 .1\n";
    (void)state;
    assert_true(reaches(small, orl_v3(1, 1, 1), 1));
    assert_true(reaches(encased, orl_v3(1, 1, 1), 1));
    assert_false(reaches(hidden, orl_v3(1, 1, 1), 1));
}

static void test_windows_and_solids(void **state)
{
    static const char room[] = ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
        "!genbox w block 1 1 1 | xform -t 1 3 0\n";
    static const char night[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    (void)state;
    assert_true(reaches(room, orl_v3(3, 1, 1), 1));
    assert_false(reaches(room, orl_v3(1.5, 3.5, .5), 1));
    assert_false(reaches(night, orl_v3(3, 1, 1), 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed),
        cmocka_unit_test(test_hole),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_windows_and_solids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
