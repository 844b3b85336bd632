/*
 * A uniformly sunlit square, read by a final gather: all photon groups there state one value, known
 * in closed form. The number of photons in a map determines how its groups of sixteen divide into
 * squares, and must not change the mean.
 *
 * Reference: the irradiance of a sensor from a diffuse rectangle (Siegel and Howell, configuration
 * factors).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "support/oracles.h"
#include "support/scene_text.h"

static const char scene[] = "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
                            "void plastic grey 0 0 5 .3 .3 .3 0 0\n"
                            "grey polygon field 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n";

enum { SENSORS = 8, SEEDS = 2, RAYS = 16384 };

/* Lux on a surface that faces a sun of 1e6 W/(sr m2) and .533 degrees, at 45 degrees. */
static double sun_lx(void)
{
    const double sine = sin(0.25 * 0.533 * ORL_PI / 180);
    return 179e6 * 4 * ORL_PI * sine * sine * sqrt(0.5);
}

/*
 * 262 144 rays of eight sensors, a fifth of which hit the square, scatter by 0.1 % in all, and the
 * values of the groups by less. Amid their own photons they read 0.26 and 0.54 % too little.
 */
static void test_square(void **state)
{
    static const uint64_t photons[] = {300000, 1000000};
    struct orl_sensor asked[SENSORS];
    double lx[SENSORS];
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        asked[i] = (struct orl_sensor){{2, 0.25 + 0.5 * i, 3}, {0, 0, -1}};
    for (size_t p = 0; p < sizeof photons / sizeof *photons; p++) {
        double off = 0;
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            scene_run_lx(&(struct scene_run){.scene = scene,
                                             .sensors = asked,
                                             .n_sensors = SENSORS,
                                             .seed = seed,
                                             .technique = ORL_TECHNIQUE_GATHER,
                                             .global = photons[p],
                                             .samples = RAYS},
                         lx);
            for (int i = 0; i < SENSORS; i++) {
                const double factor =
                    oracle_rectangle(asked[i].position, asked[i].direction, orl_v3(0, 0, 0),
                                     orl_v3(4, 0, 0), orl_v3(0, 4, 0));
                off += (lx[i] / (0.3 * sun_lx() * factor) - 1) / (SENSORS * SEEDS);
            }
        }
        print_message("%u photons: %+.2f %%\n", (unsigned)photons[p], 100 * off);
        assert_true(fabs(off) < 0.003);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_square)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
