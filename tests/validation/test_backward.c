/*
 * The backward technique compared with closed forms, and with the gather technique; the two share
 * neither density estimates nor the final gather. Backward states standard errors, which are tested
 * too.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/room.h"
#include "support/scene_text.h"

static struct orl_result run_backward(const char *scene, const char *resource,
                                      const struct orl_sensor *sensors, size_t n, uint64_t seed)
{
    return scene_run(&(struct scene_run){.scene = scene,
                                         .resource_name = resource ? "pane.xml" : NULL,
                                         .resource_text = resource,
                                         .sensors = sensors,
                                         .n_sensors = n,
                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                         .seed = seed,
                                         .global = 100000});
}

/* Asserts a difference within 4 stated standard errors (16 batches: once in 1000), which are below
 * a share of the value. */
static void assert_agrees(const struct orl_result *r, size_t i, double expected, double most_error)
{
    const double off = fabs(r->illuminance_lx[i] - expected), se = r->standard_error_lx[i];
    if (!(off <= 4 * se + 1e-9 * expected) || !(se <= most_error * expected))
        fail_msg("sensor %zu: %g +- %g is not %g", i, r->illuminance_lx[i], se, expected);
}

/*
 * A lamp of radius a in a sphere: direct pi L a^2, and the rest as the sum of a geometric series.
 */
static void test_integrating_sphere(void **state)
{
    static const struct orl_sensor sensors[2] = {{{0, 0, -1}, {0, 0, 1}}, {{1, 0, 0}, {-1, 0, 0}}};
    static const double reflectances[3] = {0.2, 0.5, 0.9};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double rho = reflectances[i], a = 0.1;
        const double total = ORL_EFFICACY_LM_PER_W * ORL_PI * 100 * a * a / (1 - rho * (1 - a * a));
        char scene[512];
        snprintf(scene, sizeof scene,
                 "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
                 "void plastic w 0 0 5 %g %g %g 0 0\nw bubble wall 0 0 4 0 0 0 1\n",
                 rho, rho, rho);
        struct orl_result r = run_backward(scene, NULL, sensors, 2, 1);
        for (size_t k = 0; k < 2; k++)
            assert_agrees(&r, k, total, 0.02);
        orl_result_done(&r);
    }
}

/* A uniform sky seen through 2 x 1.5 m at 2 m: the sky component in closed form (0.039089 of E_h),
 * no walls. */
static void test_sky_component(void **state)
{
    static const char scene[] =
        "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
        "void plastic w 0 0 5 0 0 0 0 0\n"
        "w polygon around 0 0 30 -9 2 -9 9 2 -9 9 2 9 -9 2 9 -9 2 -9 0 2 0 0 2 1.5 2 2 1.5 2 2 0 "
        "0 2 0\n";
    static const struct orl_sensor sensor = {{0, 0, 0}, {0, 0, 1}};
    static const char walls[] = "w polygon back 0 0 12 -9 -9 -9 9 -9 -9 9 -9 9 -9 -9 9\n"
                                "w polygon left 0 0 12 -9 -9 -9 -9 2 -9 -9 2 9 -9 -9 9\n"
                                "w polygon right 0 0 12 9 -9 -9 9 -9 9 9 2 9 9 2 -9\n"
                                "w polygon top 0 0 12 -9 -9 9 -9 2 9 9 2 9 9 -9 9\n"
                                "w polygon foot 0 0 12 -9 -9 -9 9 -9 -9 9 2 -9 -9 2 -9\n";
    char text[2048];
    (void)state;
    snprintf(text, sizeof text, "%s%s", scene, walls);
    struct orl_result r = run_backward(text, NULL, &sensor, 1, 1);
    assert_agrees(&r, 0, 0.039089 * ORL_EFFICACY_LM_PER_W * ORL_PI, 0.05);
    orl_result_done(&r);
}

/*
 * A sunny room with a clear window, by both techniques: the gather's noise and bias at 300000
 * photons are some 2 %, and the unbiased technique adds its standard error.
 */
static void test_both_techniques(void **state)
{
    static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    double gathered[ROOM_SENSORS];
    (void)state;
    scene_run_lx(
        &(struct scene_run){
            .scene = scene, .sensors = room_sensors, .n_sensors = ROOM_SENSORS, .global = 300000},
        gathered);
    struct orl_result r = run_backward(scene, NULL, room_sensors, ROOM_SENSORS, 1);
    for (size_t i = 0; i < ROOM_SENSORS; i++) {
        const double bound = 0.06 * r.illuminance_lx[i] + 3 * r.standard_error_lx[i];
        if (!(fabs(gathered[i] - r.illuminance_lx[i]) <= bound))
            fail_msg("sensor %zu: gather %g, backward %g +- %g", i, gathered[i],
                     r.illuminance_lx[i], r.standard_error_lx[i]);
    }
    orl_result_done(&r);
}

/*
 * Standard errors: results scatter over seeds by no more than the stated error. The stated error is
 * larger, here by 1.6, because the batches share the low-discrepancy sequence of the photons and
 * are therefore more alike together than apart.
 */
static void test_standard_errors(void **state)
{
    enum { SEEDS = 24 };
    static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    double sum = 0, squares = 0, told = 0;
    (void)state;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = run_backward(scene, NULL, room_sensors, 1, seed);
        sum += r.illuminance_lx[0];
        squares += r.illuminance_lx[0] * r.illuminance_lx[0];
        told += r.standard_error_lx[0] * r.standard_error_lx[0] / SEEDS;
        orl_result_done(&r);
    }
    const double seen = (squares - sum * sum / SEEDS) / (SEEDS - 1);
    /* A variance of 24 samples has a relative error of sqrt(2 / 23) = 0.3, its logarithm 0.3. */
    assert_true(log(seen / told) <= 0.9 && log(seen / told) >= log(0.1));
}

/*
 * Without interreflection walls are black to sensors: on the shelf's side of the room only sky and
 * sun remain, by either technique, and the gather has no density bias. Its 4096 rays are sampled by
 * the cosine alone: where the window is small, few of them reach the sky.
 */
static void test_no_reflections(void **state)
{
    static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    enum orl_effect_override overrides[ORL_EFFECT_COUNT] = {ORL_OVERRIDE_AUTO};
    (void)state;
    overrides[ORL_EFFECT_INTERREFLECTION] = ORL_OVERRIDE_SKIP;
    struct scene_run run = {.scene = scene,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .global = 100000,
                            .overrides = overrides,
                            .technique = ORL_TECHNIQUE_GATHER};
    struct orl_result gathered = scene_run(&run);
    run.technique = ORL_TECHNIQUE_BACKWARD;
    struct orl_result r = scene_run(&run);
    struct orl_result full = run_backward(scene, NULL, room_sensors, ROOM_SENSORS, 1);
    for (size_t i = 0; i < ROOM_SENSORS; i++) {
        const double most = ORL_EFFICACY_LM_PER_W * ORL_PI, lx = r.illuminance_lx[i];
        const double few = 3 * sqrt(fmin(lx, most) * most / 4096);
        const double bound = 0.02 * lx + few + 4 * r.standard_error_lx[i];
        assert_true(r.illuminance_lx[i] < full.illuminance_lx[i]);
        if (!(fabs(gathered.illuminance_lx[i] - r.illuminance_lx[i]) <= bound))
            fail_msg("sensor %zu: gather %g, backward %g +- %g", i, gathered.illuminance_lx[i],
                     r.illuminance_lx[i], r.standard_error_lx[i]);
    }
    orl_result_done(&gathered);
    orl_result_done(&full);
    orl_result_done(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_integrating_sphere), cmocka_unit_test(test_sky_component),
        cmocka_unit_test(test_both_techniques),    cmocka_unit_test(test_standard_errors),
        cmocka_unit_test(test_no_reflections),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
