/*
 * A sun beam through a small pane in the roof of a black room is a patch on the floor, and all the
 * light. Few uniform rays of a sensor hit it, about one of 4096. Photons are dense there, so that
 * leaves of the map are a millimetre wide and very bright. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/scene_text.h"

/* 4 x 5 x 3 m; the pane is 8 x 8 cm, above a sheet of 40 x 40 cm that reflects a half. */
static const char scene[] =
    "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 0 1 .533\n"
    "void plastic w 0 0 5 .001 .001 .001 0 0\nvoid plastic b 0 0 5 .5 .5 .5 0 0\n"
    "void glass p 0 0 3 .96 .96 .96\n"
    "w polygon floor 0 0 30 0 0 0 4 0 0 4 5 0 0 5 0 0 0 0 "
    "1.8 2.3 0 1.8 2.7 0 2.2 2.7 0 2.2 2.3 0 1.8 2.3 0\n"
    "b polygon sheet 0 0 12 1.8 2.3 0 2.2 2.3 0 2.2 2.7 0 1.8 2.7 0\n"
    "w polygon ceiling 0 0 30 0 0 3 0 5 3 4 5 3 4 0 3 0 0 3 "
    "1.96 2.46 3 2.04 2.46 3 2.04 2.54 3 1.96 2.54 3 1.96 2.46 3\n"
    "p polygon pane 0 0 12 1.96 2.46 3 1.96 2.54 3 2.04 2.54 3 2.04 2.46 3\n"
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
    "w polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n";

enum { SENSORS = 4, SEEDS = 6 };
static const struct orl_sensor sensors[SENSORS] = {{{.5, 2.5, 1.5}, {0, 0, -1}},
                                                   {{2, .5, 1}, {0, 1, 0}},
                                                   {{3.5, 4.5, 2.5}, {-1, -1, -1}},
                                                   {{3, 2, 2}, {-.5, .5, -1}}};

/* Treats the patch as a point, accurate to 1e-3 at these distances. */
static double truth(const struct orl_sensor *sensor)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD, transmittance = 0.88146;
    const double flux =
        1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half) * transmittance * 0.08 * 0.08;
    const struct orl_vec3 way = orl_sub(orl_v3(2, 2.5, 0), sensor->position);
    const double d2 = orl_dot(way, way), d = sqrt(d2);
    const double here = orl_dot(way, orl_normalize(sensor->direction)) / d, there = -way.z / d;
    return ORL_EFFICACY_LM_PER_W * 0.5 * flux / ORL_PI * here * there / d2;
}

/*
 * About 60 to 200 of 256 rays guided by photons hit the patch, and its rim is a third of it. The
 * error is therefore 4 to 8 % per sensor, and 1 % for the mean of 24. The patch's leaves add 1 to 2
 * %, because they extend as far as their photons. With uniform rays alone the root mean square is
 * 0.9. The truth lies in 95 % of 24 intervals, with a binomial scatter of 1.1; 19 is almost four
 * times that below.
 */
static void test_patch(void **state)
{
    double squares = 0, sumoff = 0;
    int covered = 0;
    (void)state;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                            .sensors = sensors,
                                                            .n_sensors = SENSORS,
                                                            .seed = seed,
                                                            .global = 300000,
                                                            .samples = 4096});
        for (size_t i = 0; i < SENSORS; i++) {
            const double should = truth(&sensors[i]);
            const double off = r.illuminance_lx[i] / should - 1;
            sumoff += off / (SENSORS * SEEDS);
            squares += off * off / (SENSORS * SEEDS);
            covered += r.interval_95_lx[i][0] <= should && should <= r.interval_95_lx[i][1];
        }
        orl_result_done(&r);
    }
    print_message("mean off %.4f rms %.4f, covered %d of %d\n", sumoff, sqrt(squares), covered,
                  SENSORS * SEEDS);
    assert_true(fabs(sumoff) < 0.04);
    assert_true(sqrt(squares) < 0.1);
    assert_true(covered >= 19);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_patch)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
