/*
 * A house of a few metres on a ground of 300 m, beside a lamp of almost no light: its inside is lit
 * by the sun through a doorway and by reflection from the ground. Most photons of the sky would
 * light the ground and be lost, or start at the lamp; a sensor inside would get a few that weigh as
 * much as thousands. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "support/scene_text.h"

/* 6 x 8 x 3 m, all grey; the south is open from 1 to 5 m, up to 2.4 m, and so is a hatch above. */
static const char scene[] =
    "void light sun 0 0 3 5.7e6 5.7e6 5.7e6\nsun source s 0 0 4 -.14 -.81 .57 .533\n"
    "void glow sky 0 0 4 20 25 35 0\nsky source d 0 0 4 0 0 1 180\n"
    "void glow panel 0 0 4 1 1 1 0\npanel polygon p 0 0 12 2 4 2.9 2 5 2.9 3 5 2.9 3 4 2.9\n"
    "void plastic g 0 0 5 .4 .4 .4 0 0\n"
    "g polygon ground 0 0 12 -150 -150 -.1 150 -150 -.1 150 150 -.1 -150 150 -.1\n"
    "void plastic w 0 0 5 .5 .5 .5 0 0\n"
    "w polygon floor 0 0 12 0 0 0 6 0 0 6 8 0 0 8 0\n"
    "w polygon ceiling 0 0 12 0 0 3 0 8 3 6 8 3 6 0 3\n"
    "w polygon west 0 0 12 0 0 0 0 8 0 0 8 3 0 0 3\n"
    "w polygon east 0 0 12 6 0 0 6 0 3 6 8 3 6 8 0\n"
    "w polygon north 0 0 12 0 8 0 6 8 0 6 8 3 0 8 3\n"
    "w polygon south 0 0 30 0 0 0 0 0 3 6 0 3 6 0 0 0 0 0 "
    "1 0 0 5 0 0 5 0 2.4 1 0 2.4 1 0 0\n";

enum { SENSORS = 4, SEEDS = 8 };
static const struct orl_sensor sensors[SENSORS] = {{{3, 6, .8}, {0, 0, 1}},
                                                   {{1, 7, 1.2}, {0, 0, 1}},
                                                   {{5, 7, 1.5}, {-1, 0, 0}},
                                                   {{3, 7.5, 1.2}, {0, 1, 0}}};

/* Returns the standard deviation over seeds at a sensor, over their mean. */
static double spread_of(double lx[SEEDS][SENSORS], int sensor)
{
    double mean = 0, squares = 0;
    for (int seed = 0; seed < SEEDS; seed++)
        mean += lx[seed][sensor] / SEEDS;
    for (int seed = 0; seed < SEEDS; seed++)
        squares += (lx[seed][sensor] / mean - 1) * (lx[seed][sensor] / mean - 1);
    return sqrt(squares / (SEEDS - 1));
}

/*
 * 14.8 % as measured; the rms of four spreads by 8 seeds each scatters by 13 % of itself (28
 * degrees of freedom), and twice as much is far beyond that. Before emission was importance-sampled
 * by the root of the contribution, and away from the lamp, it was 143 %.
 */
static void test_within_a_house(void **state)
{
    double lx[SEEDS][SENSORS], squares = 0;
    (void)state;
    for (int seed = 0; seed < SEEDS; seed++)
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                         .samples = 1024,
                                         .seed = (uint64_t)seed + 1},
                     lx[seed]);
    for (int i = 0; i < SENSORS; i++) {
        const double spread = spread_of(lx, i);
        print_message("sensor %d: %.0f lx, spread %.1f %%\n", i, lx[0][i], 100 * spread);
        squares += spread * spread / SENSORS;
    }
    assert_true(sqrt(squares) < 0.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_within_a_house)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
