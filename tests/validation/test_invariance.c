/*
 * Invariance under threads, repetition, units, position, orientation, and the direction of a
 * surface's normal. Also the keys of photon maps.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/room.h"

static void assert_within(double value, double expected, double relative)
{
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.6g is not within %.2g of %.6g", value, relative, expected);
}

/*
 * ---- The same bytes ---------------------------------------------------------------------------
 */

static void test_threads(void **state)
{
    static const uint32_t threads[3] = {2, 7, 1};
    struct room_bytes first = room_run_all(1, 1);
    (void)state;
    for (int t = 0; t < 3; t++) {
        struct room_bytes other = room_run_all(threads[t], 1);
        assert_true(room_same_bytes(&first, &other));
        room_free_bytes(&other);
    }
    room_free_bytes(&first);
}

/* Another seed changes every number, by no more than noise. */
static void test_seeds(void **state)
{
    struct room_bytes a = room_run_all(1, 1), b = room_run_all(1, 2);
    (void)state;
    for (int i = 0; i < ROOM_SENSORS; i++) {
        assert_true(a.lx[i] != b.lx[i]);
        assert_within(a.lx[i], b.lx[i], 0.25);
    }
    for (int i = 0; i < 3; i++)
        assert_true(a.size[i] != b.size[i] || memcmp(a.data[i], b.data[i], a.size[i]) != 0);
    room_free_bytes(&a);
    room_free_bytes(&b);
}

/*
 * ---- The same numbers -------------------------------------------------------------------------
 */

/*
 * Millimetres, kilometres, 100 km from the origin, rotated by 37 degrees. Rounding changes photon
 * paths, so that results are new samples rather than equal: single sensors of this room scatter by
 * 1 % at 2e5 photons, so 3 sigma of a difference are 4.2 %.
 */
static void test_units_and_place(void **state)
{
    static const struct room_change changes[5] = {{1, 0, {0, 0, 0}},
                                                  {0.001, 0, {0, 0, 0}},
                                                  {1000, 0, {0, 0, 0}},
                                                  {1, 0, {1e5, -1e5, 1e3}},
                                                  {1, 37, {10, 20, 0}}};
    double first[ROOM_SENSORS], lx[ROOM_SENSORS];
    (void)state;
    room_changed_lx(&changes[0], 200000, 1, first);
    for (int c = 1; c < 5; c++) {
        room_changed_lx(&changes[c], 200000, 1, lx);
        for (int i = 0; i < ROOM_SENSORS; i++)
            assert_within(lx[i], first[i], 0.042);
    }
}

/* Every wall inverted: plastic is two-sided, so only the random samples may change. */
static void test_flipped_normals(void **state)
{
    struct scene_run run = {.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .global = 200000};
    double a[ROOM_SENSORS], b[ROOM_SENSORS];
    (void)state;
    scene_run_lx(&run, a);
    run.scene = room_flipped;
    scene_run_lx(&run, b);
    for (int i = 0; i < ROOM_SENSORS; i++)
        assert_within(b[i], a[i], 0.042);
}

/*
 * Room, sky and sun are mirror-symmetric about x = 2, and so are results. Over ten seeds of 300000
 * photons the worst pair's difference scatters by 1.4 %; twice as many make that 1.0 % (there are
 * enough rays not to add to it).
 */
static void test_symmetry(void **state)
{
    static const struct orl_sensor pairs[6] = {{{0.5, 3, 0}, {0, 0, 1}}, {{3.5, 3, 0}, {0, 0, 1}},
                                               {{1, 4.5, 1}, {1, 0, 0}}, {{3, 4.5, 1}, {-1, 0, 0}},
                                               {{0, 4, 1.5}, {1, 0, 0}}, {{4, 4, 1.5}, {-1, 0, 0}}};
    double lx[6];
    (void)state;
    scene_run_lx(
        &(struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                            .sensors = pairs,
                            .n_sensors = 6,
                            .samples = 32768,
                            .global = 600000},
        lx);
    for (int i = 0; i < 6; i += 2)
        assert_within(lx[i], lx[i + 1], 0.035);
}

/*
 * ---- Windows ----------------------------------------------------------------------------------
 */

/*
 * A clear pane across the middle of the room (index 1, no absorption) is no port: it transmits all
 * light, and adds none. Two such panes in the window, one behind the other, transmit light once.
 * There are many rays, so that the difference is that of the maps.
 */
static void test_panes_that_are_no_ports(void **state)
{
    static const char none[] = "void glass q 0 0 4 1 1 1 1\n";
    char text[4096];
    struct scene_run run = {.scene = text,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .global = 200000,
                            .samples = 16384};
    double plain[ROOM_SENSORS], inner[ROOM_SENSORS], twice[ROOM_SENSORS];
    (void)state;
    snprintf(text, sizeof text, "%s", ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE);
    scene_run_lx(&run, plain);
    snprintf(text, sizeof text, "%s%sq polygon inner 0 0 12 0 2.5 0 0 2.5 3 4 2.5 3 4 2.5 0\n",
             ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE, none);
    scene_run_lx(&run, inner);
    snprintf(text, sizeof text,
             "%s%sq polygon second 0 0 12 1 .01 1 1 .01 2.5 3 .01 2.5 3 .01 1\n"
             "q polygon third 0 0 12 1 -.01 1 1 -.01 2.5 3 -.01 2.5 3 -.01 1\n"
             "w polygon rim1 0 0 12 1 .01 1 3 .01 1 3 -.01 1 1 -.01 1\n"
             "w polygon rim2 0 0 12 1 .01 2.5 3 .01 2.5 3 -.01 2.5 1 -.01 2.5\n"
             "w polygon rim3 0 0 12 1 .01 1 1 .01 2.5 1 -.01 2.5 1 -.01 1\n"
             "w polygon rim4 0 0 12 3 .01 1 3 .01 2.5 3 -.01 2.5 3 -.01 1\n",
             ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE, none);
    scene_run_lx(&run, twice);
    for (int i = 0; i < ROOM_SENSORS; i++) {
        assert_within(inner[i], plain[i], 0.042);
        /* The frame is two centimetres deep: it blocks 1 % and more of slanting light. */
        assert_within(twice[i], plain[i], 0.06);
    }
}

/*
 * A window at the bottom of a light well that sees a sliver of the sky is a port, and its light
 * equals that of an open hole. Well and room share no plane, so that density estimates at the hole
 * cannot reach round the wall. Most light at the sensors has been reflected in the well, where few
 * paths from inside find it: seeds scatter by 5 % and more.
 */
static void test_light_well(void **state)
{
    static const char well[] =
        "w polygon well_s 0 0 12 -.5 -2 -.2 4.5 -2 -.2 4.5 -2 6 -.5 -2 6\n"
        "w polygon well_w 0 0 12 -.5 -2 -.2 -.5 -2 6 -.5 .1 6 -.5 .1 -.2\n"
        "w polygon well_e 0 0 12 4.5 -2 -.2 4.5 .1 -.2 4.5 .1 6 4.5 -2 6\n"
        "w polygon well_n 0 0 12 -.5 .1 3 4.5 .1 3 4.5 .1 6 -.5 .1 6\n"
        "w polygon well_f 0 0 12 -.5 -2 -.2 4.5 -2 -.2 4.5 .1 -.2 -.5 .1 -.2\n"
        "w polygon gap_w 0 0 12 -.5 .1 -.2 0 .1 -.2 0 .1 3 -.5 .1 3\n"
        "w polygon gap_e 0 0 12 4 .1 -.2 4.5 .1 -.2 4.5 .1 3 4 .1 3\n";
    char text[4096];
    double hole[ROOM_SENSORS], pane[ROOM_SENSORS];
    struct scene_run run = {
        .scene = text, .sensors = room_sensors, .n_sensors = ROOM_SENSORS, .global = 300000};
    (void)state;
    /* The invisible pane compared with the open hole: the pane is a port, the hole gets photons
     * from the sky. */
    snprintf(text, sizeof text, "%s%s%s",
             ROOM_SKY ROOM_GREY "void glass p 0 0 4 1 1 1 1\n" ROOM_SHELL, well, ROOM_PANE);
    scene_run_lx(&run, pane);
    snprintf(text, sizeof text, "%s%s", ROOM_SKY ROOM_GREY ROOM_SHELL, well);
    run.global = 1000000;
    scene_run_lx(&run, hole);
    for (int i = 0; i < ROOM_SENSORS; i++) {
        assert_true(pane[i] > 0);
        assert_within(pane[i], hole[i], 0.17);
    }
}

/*
 * ---- Keys -------------------------------------------------------------------------------------
 */

static void expect_cached(const struct scene_run *run, bool global, bool caustic)
{
    struct orl_result result = scene_run(run);
    assert_int_equal(result.n_maps, 2);
    assert_int_equal(result.maps[0].cached, global);
    assert_int_equal(result.maps[1].cached, caustic);
    orl_result_done(&result);
}

/* A new sensor list or view is a cache hit; a new seed, count or scene is a miss. */
static void test_map_keys(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct scene_run run = {.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                            .sensors = room_sensors,
                            .n_sensors = 2,
                            .global = 5000,
                            .caustic = 5000,
                            .overrides = scene_wish_maps,
                            .samples = 64,
                            .folder = folder};
    expect_cached(&run, false, false);
    expect_cached(&run, true, true);
    run.n_sensors = 4;
    run.samples = 128;
    expect_cached(&run, true, true);
    run.view = "-vtv -vp 2 4 1.5 -vd 0 -1 0";
    run.width = run.height = 8;
    run.threads = 2;
    expect_cached(&run, true, true);
    run.view = NULL;
    run.caustic = 6000;
    expect_cached(&run, true, false);
    run.seed = 2;
    expect_cached(&run, false, false);
    run.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE "# said twice\n";
    expect_cached(&run, false, false);
    cli_remove_folder(folder);
}

/* Results of a cached map equal those of a new one, to the bit. */
static void test_cached_results(void **state)
{
    char folder[64];
    double first[ROOM_SENSORS], second[ROOM_SENSORS];
    (void)state;
    cli_make_folder(folder);
    const struct scene_run run = {.scene =
                                      ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                                  .sensors = room_sensors,
                                  .n_sensors = ROOM_SENSORS,
                                  .caustic = 5000,
                                  .overrides = scene_wish_maps,
                                  .folder = folder};
    scene_run_lx(&run, first);
    scene_run_lx(&run, second);
    assert_memory_equal(first, second, sizeof first);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads),         cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_units_and_place), cmocka_unit_test(test_flipped_normals),
        cmocka_unit_test(test_symmetry),        cmocka_unit_test(test_panes_that_are_no_ports),
        cmocka_unit_test(test_light_well),      cmocka_unit_test(test_map_keys),
        cmocka_unit_test(test_cached_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
