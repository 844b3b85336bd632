/*
 * A sensor in mid-air so close to a ball of glass that photons which fly by would be averaged over
 * a wider area than the ball is away. Light varies there within a centimetre: the interval has to
 * hold what paths find, whatever few photons bring.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "support/scene_text.h"

/* A closed room with a lamp above a ball of glass. */
#define ROOM                                                                                       \
    "void plastic w 0 0 5 .4 .4 .4 0 0\nvoid dielectric glass 0 0 5 1 1 1 1.5 0\n"                 \
    "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 1.2 1.8 2.3 .3\n"                         \
    "glass sphere ball 0 0 4 1.8 2 1.5 .4\n"                                                       \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3\n"                                           \
    "w polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"                                             \
    "w polygon north 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3\n"                                             \
    "w polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0\n"

/* 1.2 and 70 cm from the ball, facing down. */
enum { SENSORS = 2, SEEDS = 6 };
static const struct orl_sensor sensors[SENSORS] = {{{2.2, 2, 1.6}, {0, 0, -1}},
                                                   {{2.9, 2, 1.6}, {0, 0, -1}}};

static struct orl_result run(enum orl_technique technique, uint32_t samples, uint64_t seed)
{
    return scene_run(&(struct scene_run){.scene = ROOM,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .technique = technique,
                                         .global = 50000,
                                         .caustic = 16000,
                                         .samples = samples,
                                         .seed = seed});
}

static void test_intervals_hold_beside_a_lens(void **state)
{
    struct orl_result truth = run(ORL_TECHNIQUE_BACKWARD, 32768, 1);
    (void)state;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = run(ORL_TECHNIQUE_GATHER, 1024, seed);
        for (int i = 0; i < SENSORS; i++) {
            const double slack = 4 * truth.standard_error_lx[i], lx = truth.illuminance_lx[i];
            const double *interval = r.interval_95_lx[i];
            if (!(interval[0] < lx + slack && interval[1] > lx - slack))
                fail_msg("seed %d, sensor %d: %g [%g, %g] for %g +- %g", (int)seed, i,
                         r.illuminance_lx[i], interval[0], interval[1], lx,
                         truth.standard_error_lx[i]);
        }
        /* Away from the ball the interval is narrow. */
        assert_true(r.interval_95_lx[1][1] - r.interval_95_lx[1][0] < 0.2 * r.illuminance_lx[1]);
        orl_result_done(&r);
    }
    orl_result_done(&truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_intervals_hold_beside_a_lens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
