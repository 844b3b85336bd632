/*
 * A ball of glass in the sun in front of a hole, or of a window: the light that it focuses into the
 * room is most of the light of some sensors. Photons started at ports would miss it
 * (scene/built/ports.h). Truths are from plain path tracing with 40 million paths per sensor
 * (support/brute.h). Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "support/rare_rooms.h"

/* A pane in the hole, with a transmittance of 81 to 84 %. */
static const char pane[] = "clear polygon p 0 0 12 1.8 0 1.2 1.8 0 1.6 2.2 0 1.6 2.2 0 1.2\n";
static const double glazed = 0.82;

static const struct brute_value truth_lx[PATH_SENSORS] = {
    {2071.9, 37}, {27.4, 5.5}, {50.2, 7.6}, {156.2, 13}, {154.9, 10}};

static void check_room(const char *more, double share, enum orl_technique technique)
{
    struct orl_result r = rare_room_run(&(struct rare_room_job){
        .name = "lens before a hole, sun", .more = more, .technique = technique, .caustic = 20000});
    for (size_t i = 0; i < PATH_SENSORS; i++) {
        const double t = share * truth_lx[i].mean, wide = 2.5 * share * truth_lx[i].standard_error;
        const double *const interval = r.interval_95_lx[i];
        print_message("%s%s, sensor %zu: %.1f [%.1f, %.1f], truth %.1f +- %.1f\n",
                      orl_technique_name(technique), *more ? ", pane" : "", i, r.illuminance_lx[i],
                      interval[0], interval[1], t, share * truth_lx[i].standard_error);
        assert_true(interval[0] - wide < t && t < interval[1] + wide);
    }
    orl_result_done(&r);
}

static void test_hole(void **state)
{
    (void)state;
    check_room("", 1, ORL_TECHNIQUE_GATHER);
    check_room("", 1, ORL_TECHNIQUE_BACKWARD);
}

static void test_window(void **state)
{
    (void)state;
    check_room(pane, glazed, ORL_TECHNIQUE_GATHER);
    check_room(pane, glazed, ORL_TECHNIQUE_BACKWARD);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hole), cmocka_unit_test(test_window)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
