/*
 * Slats across a window, as far apart as they are wide, and narrower than a density estimate's
 * disc. From below the inner edges of their undersides are visible, which the sun on the slats
 * beneath lights less than the rest: an estimate over a slat's width is too bright. The truth is
 * from the technique without density estimates. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

/* 3 x 3 x 2.5 m, black; its southern wall is open behind the slats. */
static const char room[] = "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .2 -.75 .63 .533\n"
                           "void glow g 0 0 4 20 20 20 0\ng source sky 0 0 4 0 0 1 180\n"
                           "void plastic w 0 0 5 .05 .05 .05 0 0\n"
                           "void plastic s 0 0 5 .7 .7 .7 0 0\n"
                           "void glass p 0 0 3 .96 .96 .96\n"
                           "w polygon floor 0 0 12 0 0 0 3 0 0 3 3 0 0 3 0\n"
                           "w polygon ceiling 0 0 12 0 0 2.5 0 3 2.5 3 3 2.5 3 0 2.5\n"
                           "w polygon west 0 0 12 0 0 0 0 3 0 0 3 2.5 0 0 2.5\n"
                           "w polygon east 0 0 12 3 0 0 3 0 2.5 3 3 2.5 3 3 0\n"
                           "w polygon north 0 0 12 0 3 0 3 3 0 3 3 2.5 0 3 2.5\n"
                           "p polygon pane 0 0 12 0 0 0 0 0 2.5 3 0 2.5 3 0 0\n";

enum { SENSORS = 2, SEEDS = 4, SLATS = 49 };

static const struct orl_sensor sensors[SENSORS] = {{{1.5, .6, .6}, {0, 0, 1}},
                                                   {{1, 1, .3}, {0, 0, 1}}};

/* 5 cm wide and apart, tilted by 30 degrees, the inner edges up. */
static void put_slats(char *scene, size_t size)
{
    size_t n = (size_t)snprintf(scene, size, "%s", room);
    for (int i = 0; i < SLATS; i++) {
        const double z = 0.02 + 0.05 * i;
        n += (size_t)snprintf(scene + n, size - n,
                              "s polygon s%d 0 0 12 .01 .1 %.3f 2.99 .1 %.3f 2.99 .1433 %.3f "
                              ".01 .1433 %.3f\n",
                              i, z, z, z + 0.025, z + 0.025);
    }
    assert_true(n < size);
}

static void mean_of(const char *scene, enum orl_technique technique, uint64_t global,
                    double ret_mean[SENSORS], double ret_error[SENSORS])
{
    for (int i = 0; i < SENSORS; i++)
        ret_mean[i] = ret_error[i] = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                            .technique = technique,
                                                            .sensors = sensors,
                                                            .n_sensors = SENSORS,
                                                            .seed = seed,
                                                            .global = global,
                                                            .samples = 4096});
        for (int i = 0; i < SENSORS; i++) {
            ret_mean[i] += r.illuminance_lx[i] / SEEDS;
            ret_error[i] += r.standard_error_lx[i] * r.standard_error_lx[i] / (SEEDS * SEEDS);
        }
        orl_result_done(&r);
    }
    for (int i = 0; i < SENSORS; i++)
        ret_error[i] = sqrt(ret_error[i]);
}

static void test_slats(void **state)
{
    char scene[16384];
    double should[SENSORS], is[SENSORS], of_should[SENSORS], of_is[SENSORS];
    (void)state;
    put_slats(scene, sizeof scene);
    mean_of(scene, ORL_TECHNIQUE_BACKWARD, 0, should, of_should);
    mean_of(scene, ORL_TECHNIQUE_GATHER, 100000, is, of_is);
    for (int i = 0; i < SENSORS; i++) {
        const double error = hypot(of_should[i], of_is[i]);
        print_message("sensor %d: %.1f +- %.1f, should be %.1f +- %.1f: %+.1f %%\n", i, is[i],
                      of_is[i], should[i], of_should[i], 100 * (is[i] / should[i] - 1));
        assert_true(fabs(is[i] - should[i]) < 4 * error);
        assert_true(error < 0.03 * should[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slats)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
