/*
 * Sensors beside a ball of glass.
 *
 * A free sensor is so close to a ball of glass that photons passing by would be averaged over a
 * radius wider than the distance to the ball. Light varies there within a centimetre: the interval
 * has to hold the value of path tracing, whatever the few photons contribute.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>
#include <math.h>

#include "support/scene_fixture.h"
#include "support/scene_text.h"

/* Sensors 1.2 and 70 cm from the ball, facing down. */
enum { SENSORS = 2, SEEDS = 6 };
static const struct orl_sensor sensors[SENSORS] = {{{2.2, 2, 1.6}, {0, 0, -1}},
                                                   {{2.9, 2, 1.6}, {0, 0, -1}}};

static struct orl_result run_room(enum orl_technique technique, uint32_t samples, uint64_t seed)
{
    return scene_run(&(struct scene_run){.scene = scene_fixture("room_lamp_and_lens"),
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
    struct orl_result truth = run_room(ORL_TECHNIQUE_BACKWARD, 32768, 1);
    (void)state;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = run_room(ORL_TECHNIQUE_GATHER, 1024, seed);
        for (int i = 0; i < SENSORS; i++) {
            const double slack = 4 * truth.standard_error_lx[i], lx = truth.illuminance_lx[i];
            const double *interval = r.interval_95_lx[i];
            if (!(interval[0] < lx + slack && interval[1] > lx - slack))
                fail_msg("seed %d, sensor %d: %g [%g, %g] for %g +- %g", (int)seed, i,
                         r.illuminance_lx[i], interval[0], interval[1], lx,
                         truth.standard_error_lx[i]);
        }
        /* The interval is narrow away from the ball. */
        assert_true(r.interval_95_lx[1][1] - r.interval_95_lx[1][0] < 0.2 * r.illuminance_lx[1]);
        orl_result_done(&r);
    }
    orl_result_done(&truth);
}

/* One ray of 250 of the first sensor hits the ball, in which it sees the sky: a sixth of its light.
 * The others see a smaller ball, or see it from the side where it shows them the window. */
static const struct orl_sensor by_window[] = {
    {{2.2, 2, 1.6}, {0, 0, -1}}, {{2, 3.5, 1.6}, {0, 0, -1}}, {{1, 2, 1.4}, {0.2, 0.2, -1}}};
enum { BY_WINDOW = sizeof by_window / sizeof *by_window, RARE_SEEDS = 12 };

static struct orl_result run_by_window(const char *scene, enum orl_technique technique,
                                       uint32_t samples, uint64_t seed)
{
    return scene_run(&(struct scene_run){.scene = scene,
                                         .sensors = by_window,
                                         .n_sensors = BY_WINDOW,
                                         .technique = technique,
                                         .global = 20000,
                                         .samples = samples,
                                         .seed = seed});
}

/* Differences from the truth in stated standard errors: 16 batches give them 15 degrees of freedom,
 * so the rms should be 1.07. The three sensors of a run share its photons: 12 runs determine the
 * rms to .2, and the bound allows three times that. */
static void test_sky_in_small_balls_is_found(void **state)
{
    const char *const room = scene_fixture("room_window_lens");
    const char *const scenes[] = {scene_join(room, "crystal sphere ball 0 0 4 2 .5 1.6 .4\n", NULL),
                                  scene_join(room, "smooth sphere ball 0 0 4 2 .8 1.1 .2\n", NULL)};
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct orl_result truth = run_by_window(scenes[k % 2], ORL_TECHNIQUE_BACKWARD, 32768, 99);
        double squares = 0, worst = 0;
        for (uint64_t seed = 1; seed <= RARE_SEEDS; seed++) {
            struct orl_result r = run_by_window(scenes[k % 2], techniques[k / 2], 256, seed);
            for (int i = 0; i < BY_WINDOW; i++) {
                const double z = (r.illuminance_lx[i] - truth.illuminance_lx[i]) /
                                 hypot(r.standard_error_lx[i], truth.standard_error_lx[i]);
                squares += z * z;
                worst = fmax(worst, fabs(z));
            }
            orl_result_done(&r);
        }
        orl_result_done(&truth);
        const double rms = sqrt(squares / (RARE_SEEDS * BY_WINDOW));
        printf("# scene %d: rms %.2f, worst %.1f\n", k, rms, worst);
        if (!(rms < 1.7 && worst < 5))
            fail_msg("scene %d: rms %g, worst %g", k, rms, worst);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sky_in_small_balls_is_found),
        cmocka_unit_test(test_intervals_hold_beside_a_lens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
