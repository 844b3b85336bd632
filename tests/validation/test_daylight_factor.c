/* Daylight factors compared with closed forms, and with shades and rounds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support/year.h"

/* A stone far below the sensor, since a scene must not be empty. */
#define NOTHING_NEAR "void plastic w 0 0 5 0 0 0 0 0\nw sphere stone 0 0 4 0 0 -50 .1\n"

static const struct year_site izmir = {38.42, 27.14, 2};

/*
 * Asserts within 4.5 standard errors, plus the error of bins of 3 degrees for the sky's gradient.
 */
static void assert_factor(const struct orl_annual_result *year, size_t sensor, double wanted)
{
    const double found = (double)year->overcast[sensor] / 10000;
    const double se = (double)year->overcast_se[sensor] / 10000;
    print_message("%.5f +- %.5f, %.5f by form\n", found, se, wanted);
    if (!(fabs(found - wanted) <= 4.5 * se + 1e-3 * wanted))
        fail_msg("%.5f is not %.5f", found, wanted);
}

static struct orl_annual_result run_year(const char *scene, const struct orl_sensor *sensors,
                                         size_t n)
{
    return year_run(&(struct year_run){
        .scene = scene, .site = izmir, .sensors = sensors, .n_sensors = n, .samples = 2048});
}

/*
 * L = Lz (1 + 2 sin) / 3 gives a level plane 7 pi / 9 Lz, and an upright one (pi / 2 + 4 / 3) / 3
 * Lz: 0.3961 of that; the ground of 20 % adds 0.1 there. A sensor facing down there sees only the
 * ground.
 */
static void test_open_sky(void **state)
{
    static const struct orl_sensor sensors[] = {
        {{0, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, -1}}};
    struct orl_annual_result year = run_year(NOTHING_NEAR, sensors, 3);
    (void)state;
    assert_factor(&year, 0, 1);
    assert_factor(&year, 1, (ORL_PI / 2 + 4.0 / 3) * 3 / (7 * ORL_PI) + 0.1);
    assert_factor(&year, 2, 0.2);
    orl_annual_done(&year);
}

/* A black wall almost to the zenith leaves half of the sky; in the east, and between bins. */
static void test_half_a_sky(void **state)
{
    static const char east[] =
        NOTHING_NEAR "w polygon wall 0 0 12 1 -1e4 -1 1 1e4 -1 1 1e4 1e4 1 -1e4 1e4\n";
    static const char askew[] = NOTHING_NEAR
        "w polygon wall 0 0 12 -9204 -3911 -1 9206 3901 -1 9206 3901 1e4 -9204 -3911 1e4\n";
    static const struct orl_sensor sensor = {{0, 0, 0}, {0, 0, 1}};
    (void)state;
    struct orl_annual_result year = run_year(east, &sensor, 1);
    assert_factor(&year, 0, 0.5);
    orl_annual_done(&year);
    year = run_year(askew, &sensor, 1);
    assert_factor(&year, 0, 0.5);
    orl_annual_done(&year);
}

/* A level black plate overhead, whose round hole shows the sky from 60 degrees up: the light of L
 * above sin a = s is pi Lz / 3 (1 - s^2 + 4 / 3 (1 - s^3)). */
static void test_round_opening(void **state)
{
    static const char plate[] = NOTHING_NEAR "w ring plate 0 0 8 0 0 1 0 0 -1 .5773502692 1e5\n";
    static const struct orl_sensor sensor = {{0, 0, 0}, {0, 0, 1}};
    const double s = sin(ORL_PI / 3);
    (void)state;
    struct orl_annual_result year = run_year(plate, &sensor, 1);
    assert_factor(&year, 0, 3.0 / 7 * (1 - s * s + 4.0 / 3 * (1 - s * s * s)));
    orl_annual_done(&year);
}

/* The factor is that of open shades whatever the hours have; and the bytes are equal for 1, 2 and 7
 * threads. */
static void test_shades_and_threads(void **state)
{
    static const char room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}}, {{2, 4, .8}, {0, 0, 1}}};
    static char name[] = "south", pane[] = "pane", open[] = "open", shut[] = "shut";
    static char *panes[] = {pane};
    struct orl_shade_state states[] = {{.name = open}, {.name = shut, .dark = true}};
    struct orl_shade_span span = {1, 12, 0, 24, 1};
    const struct orl_window_group group = {.name = name,
                                           .windows = panes,
                                           .n_windows = 1,
                                           .states = states,
                                           .n_states = 2,
                                           .spans = &span,
                                           .n_spans = 1};
    struct year_run asked = {
        .scene = room, .site = izmir, .sensors = sensors, .n_sensors = 2, .samples = 256};
    struct orl_annual_result bare = year_run(&asked);
    (void)state;
    assert_true(bare.overcast[0] > 2 * bare.overcast[1] && bare.overcast[1] > 0);
    static const uint32_t threads[] = {1, 2, 7};
    asked.groups = &group;
    asked.n_groups = 1;
    for (int i = 0; i < 3; i++) {
        asked.threads = threads[i];
        struct orl_annual_result year = year_run(&asked);
        assert_memory_equal(year.overcast, bare.overcast, 2 * sizeof *bare.overcast);
        assert_memory_equal(year.overcast_se, bare.overcast_se, 2 * sizeof *bare.overcast_se);
        assert_true(year.total[0] == 0);
        orl_annual_done(&year);
    }
    orl_annual_done(&bare);
}

/* More paths until the target is certain: the paths of all rounds count. */
static void test_rounds(void **state)
{
    static const char room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static const struct orl_sensor sensor = {{2, 2, .8}, {0, 0, 1}};
    struct orl_report_request report_request;
    struct orl_annual_target target;
    struct orl_annual_refinement refinement = {.asked = false};
    struct year_run asked = {
        .scene = room, .site = izmir, .sensors = &sensor, .n_sensors = 1, .samples = 1 << 14};
    struct orl_annual_result truth = year_run(&asked);
    const double factor = (double)truth.overcast[0] / 100;
    char text[64];
    (void)state;
    snprintf(text, sizeof text, "DF >= %.4f %%", 1.02 * factor);
    assert_int_equal(orl_annual_target_parse(text, &target, NULL), 0);
    assert_int_equal(orl_report_request_init(&report_request), 0);
    report_request.until = &target;
    asked.samples = 32;
    asked.report_request = &report_request;
    asked.ret_refinement = &refinement;
    struct orl_annual_result year = year_run(&asked);
    assert_true(refinement.decided && refinement.rounds > 1);
    assert_int_equal(refinement.verdict, ORL_VERDICT_FAIL);
    assert_true(fabs((double)year.overcast[0] / 100 - factor) <
                4.5 * hypot((double)year.overcast_se[0], (double)truth.overcast_se[0]) / 100);
    report_request.until = NULL;
    orl_report_request_done(&report_request);
    orl_annual_done(&year);
    orl_annual_done(&truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_sky),      cmocka_unit_test(test_half_a_sky),
        cmocka_unit_test(test_round_opening), cmocka_unit_test(test_shades_and_threads),
        cmocka_unit_test(test_rounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
