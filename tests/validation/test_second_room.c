/*
 * A room that gets its light by a door from one with a window: photons are few there, rays read
 * them as crowded or near and go on, and few of these see the window by the door.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "support/path_cells.h"
#include "support/rare_rooms.h"
#include "support/scene_text.h"

enum { SEEDS = 6, ROOM = 6 };

/* Plain path tracing of 8 million paths (support/brute.h), and backward by 2^18. */
static const double truths_lx[] = {2.05, 1.90, 5.27, 3.09};
static const double off = 0.02; /* of these, standard error */

/* Before rays were aimed at the window from surfaces that are lit again, seeds gave 1.73 +- .05 to
 * 5.7 +- 2.4 at the last sensor. */
static void test_gather(void **state)
{
    static char text[PATH_TEXT];
    struct orl_sensor sensors[PATH_SENSORS];
    size_t held = 0;
    (void)state;
    assert_string_equal(rare_room_name(ROOM), "second room by a door");
    rare_room_scene(ROOM, text, sensors);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = text,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = path_pane(),
                                                            .sensors = sensors,
                                                            .n_sensors = PATH_SENSORS,
                                                            .seed = seed,
                                                            .technique = ORL_TECHNIQUE_GATHER,
                                                            .by_plan = true,
                                                            .global = 200000,
                                                            .threads = 2});
        for (size_t i = 1; i < PATH_SENSORS; i++) {
            const double t = truths_lx[i - 1], lx = r.illuminance_lx[i];
            const double *const interval = r.interval_95_lx[i];
            const double z = (lx - t) / hypot(r.standard_error_lx[i], off * t);
            print_message("seed %d, sensor %zu: %.3f [%.3f, %.3f], truth %.3f, z %.1f\n", (int)seed,
                          i, lx, interval[0], interval[1], t, z);
            held += interval[0] - 2 * off * t < t && t < interval[1] + 2 * off * t;
            assert_true(fabs(lx - t) < 0.25 * t);
        }
        orl_result_done(&r);
    }
    assert_true(held >= SEEDS * (PATH_SENSORS - 1) - 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gather)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
