/* Hard case of repeatability: the same seed gives the same bytes on any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/room.h"
#include "support/stability.h"

static void test_threads(void **state)
{
    static const uint32_t threads[4] = {2, 7, 1, 7};
    const uint64_t seeds = stability_full() ? 4 : 1;
    bool same = true;
    (void)state;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        struct room_bytes first = room_run_all(1, seed);
        for (int t = 0; t < 4; t++) {
            struct room_bytes other = room_run_all(threads[t], seed);
            same = same && room_same_bytes(&first, &other);
            room_free_bytes(&other);
        }
        room_free_bytes(&first);
    }
    stability_holds(40, "1, 2 and 7 threads, repeated",
                    "sensors, health, maps and image: same bytes", same);
}

/* Without the pane, light comes from the open sky, and emission uses an importance map. */
static void test_open_room(void **state)
{
    static const uint32_t threads[4] = {1, 2, 7, 2};
    double lx[4][ROOM_SENSORS];
    bool same = true;
    (void)state;
    for (int t = 0; t < 4; t++) {
        scene_run_lx(&(struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL,
                                         .sensors = room_sensors,
                                         .n_sensors = ROOM_SENSORS,
                                         .samples = 512,
                                         .global = stability_full() ? 2000000 : 50000,
                                         .caustic = 10000,
                                         .threads = threads[t]},
                     lx[t]);
        same = same && memcmp(lx[t], lx[0], sizeof lx[t]) == 0;
    }
    stability_holds(40, "1, 2 and 7 threads, repeated", "sensors of an open room: same bytes",
                    same);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_open_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
