/*
 * The cross-check under fault injection: a result lacks one kind of light, because the strategy
 * that finds it was switched off, and is compared with paths in the whole scene. The job must warn,
 * and name the class of light (oriel/job/run.h). Correct results cause no warning. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "support/extent.h"
#include "support/scene_text.h"

#define MATERIALS                                                                                  \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid mirror m 0 0 3 .9 .9 .9\n"                            \
    "void glass p 0 0 3 .96 .96 .96\nvoid light l 0 0 3 1e4 1e4 1e4\n"
#define GROUND "w polygon ground 0 0 12 -30 -30 -.2 30 -30 -.2 30 30 -.2 -30 30 -.2\n"
#define SKY "void glow g 0 0 4 40 40 40 0\ng source sky 0 0 4 0 0 1 180\n" GROUND
#define SUN "void light s 0 0 3 2e6 2e6 2e6\ns source sun 0 0 4 .2 -1 .8 .533\n"
#define SHELL                                                                                      \
    "w polygon floor 0 0 12 0 0 0 5 0 0 5 4 0 0 4 0\nw polygon roof 0 0 12 0 0 3 0 4 3 5 4 3 5 0 " \
    "3\nw polygon north 0 0 12 0 4 0 5 4 0 5 4 3 0 4 3\n"                                          \
    "w polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\n"
#define EAST "w polygon east 0 0 12 5 0 0 5 0 3 5 4 3 5 4 0\n"
#define EAST_MIRROR "m polygon east 0 0 12 5 0 0 5 0 3 5 4 3 5 4 0\n"
#define SOUTH "w polygon south 0 0 12 0 0 0 0 0 3 5 0 3 5 0 0\n"
/* South wall with two windows. */
#define SOUTH_OPEN                                                                                 \
    "w polygon south 0 0 48 0 0 0 0 0 3 5 0 3 5 0 0 0 0 0 .5 0 1 2 0 1 2 0 2.5 .5 0 2.5 .5 0 1 "   \
    "3 0 1 4.5 0 1 4.5 0 2.5 3 0 2.5 3 0 1 .5 0 1\n"
#define PANE_WEST "p polygon a 0 0 12 .5 0 1 .5 0 2.5 2 0 2.5 2 0 1\n"
#define PANE_EAST "p polygon b 0 0 12 3 0 1 3 0 2.5 4.5 0 2.5 4.5 0 1\n"
#define WALL_EAST "w polygon b 0 0 12 3 0 1 3 0 2.5 4.5 0 2.5 4.5 0 1\n"
#define LAMP(name, x) "l sphere " name " 0 0 4 " x " 2.6 2.4 .02\n"
#define MIRROR_FLOOR "m polygon strip 0 0 12 .6 1.3 .01 2.2 1.3 .01 2.2 2.8 .01 .6 2.8 .01\n"

enum { SENSORS = 8 };
static const struct orl_sensor sensors[SENSORS] = {
    {{.7, 1.2, .8}, {0, 0, 1}},   {{1.8, 2.2, .8}, {0, 0, 1}}, {{2.6, 1.1, .8}, {0, 0, 1}},
    {{3.6, 2.4, .8}, {0, 0, 1}},  {{4.3, 1.5, .8}, {0, 0, 1}}, {{1.2, 3.3, 1.2}, {0, -1, 0}},
    {{2.5, 3.3, 1.2}, {1, 0, 0}}, {{1.1, 2.9, .8}, {0, 0, -1}}};

/* A fault: the job leaves out an effect, or runs on a scene that lacks a part. */
static const struct fault {
    const char *name, *whole, *faulty;
    int left_out;     /* effect left out; ORL_EFFECT_COUNT: none */
    unsigned classes; /* classes most of which is then missing: flags 1 << class */
} faults[] = {
    {"images of lamps", MATERIALS SHELL EAST_MIRROR SOUTH LAMP("a", "1"), NULL,
     ORL_EFFECT_CAUSTICS_MIRROR, 1U << ORL_LIGHT_MIRRORED},
    {"images of suns", MATERIALS SUN SKY SHELL EAST SOUTH_OPEN PANE_WEST PANE_EAST MIRROR_FLOOR,
     NULL, ORL_EFFECT_CAUSTICS_MIRROR, 1U << ORL_LIGHT_MIRRORED | 1U << ORL_LIGHT_REFLECTED},
    {"a map, lamps", MATERIALS SHELL EAST SOUTH LAMP("a", "1") LAMP("b", "4"), NULL,
     ORL_EFFECT_INTERREFLECTION, 1U << ORL_LIGHT_REFLECTED},
    {"a map, sky", MATERIALS SKY SHELL EAST SOUTH_OPEN PANE_WEST PANE_EAST, NULL,
     ORL_EFFECT_INTERREFLECTION, 1U << ORL_LIGHT_REFLECTED},
    {"a port", MATERIALS SKY SHELL EAST SOUTH_OPEN PANE_WEST PANE_EAST,
     MATERIALS SKY SHELL EAST SOUTH_OPEN PANE_WEST WALL_EAST, ORL_EFFECT_COUNT,
     1U << ORL_LIGHT_OUTDOORS | 1U << ORL_LIGHT_REFLECTED},
    {"a lamp", MATERIALS SHELL EAST SOUTH LAMP("a", "1") LAMP("b", "4"),
     MATERIALS SHELL EAST SOUTH LAMP("a", "1"), ORL_EFFECT_COUNT,
     1U << ORL_LIGHT_STRAIGHT | 1U << ORL_LIGHT_REFLECTED},
};
enum { FAULTS = sizeof faults / sizeof *faults };

static struct orl_result run_scene(const char *scene, int left_out, enum orl_technique technique,
                                   uint64_t seed)
{
    enum orl_effect_override overrides[ORL_EFFECT_COUNT] = {ORL_OVERRIDE_AUTO};
    if (left_out < ORL_EFFECT_COUNT)
        overrides[left_out] = ORL_OVERRIDE_SKIP;
    return scene_run(&(struct scene_run){.scene = scene,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .technique = technique,
                                         .overrides = overrides,
                                         .by_plan = true,
                                         .global = 100000,
                                         .caustic = 50000,
                                         .samples = 512,
                                         .seed = seed});
}

static double now_s(void *ctx)
{
    (void)ctx;
    return 0;
}

/* Cross-checks a result, computed before by other means, against paths in that lit scene. */
static void check_against(struct orl_lit_scene *lit_scene, struct orl_thread_pool *pool,
                          uint64_t seed, struct orl_result *result)
{
    struct orl_job job;
    struct orl_error err = {0};
    atomic_bool cancel;
    atomic_init(&cancel, false);
    orl_job_init(&job);
    job.seed = seed;
    result->plan.most_reflections = ORL_ALL_REFLECTIONS;
    const struct orl_run_env env = {.pool = pool, .cancel = &cancel, .now_s = now_s};
    struct orl_run_state state = {.job = &job,
                                  .env = &env,
                                  .result = result,
                                  .sensors = (struct orl_sensor *)(uintptr_t)sensors,
                                  .n_sensors = SENSORS,
                                  .lit_scene = lit_scene,
                                  .samples = 1 << 20};
    assert_int_equal(orl_run_cross_check(&state, &err), 0);
}

static void test_faults(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    size_t named = 0, all = 0;
    (void)state;
    for (size_t f = 0; f < FAULTS; f++) {
        const struct fault *fault = &faults[f];
        struct orl_lit_scene *lit_scene = build_lit_scene(fault->whole, NULL, NULL, pool);
        for (uint64_t seed = 1; seed <= extent(3, 6); seed++, all++) {
            struct orl_result r = run_scene(fault->faulty ? fault->faulty : fault->whole,
                                            fault->left_out, ORL_TECHNIQUE_BACKWARD, seed);
            assert_int_equal(r.cross_check.sensors_off, 0);
            check_against(lit_scene, pool, seed, &r);
            const bool right =
                r.cross_check.sensors_off > 0 && fault->classes & 1U << r.cross_check.differs_in;
            if (!right)
                print_message("%s, seed %d: %s\n", fault->name, (int)seed,
                              r.cross_check.sensors_off > 0
                                  ? orl_light_class_name(r.cross_check.differs_in)
                                  : "nothing is said");
            named += right;
            orl_result_done(&r);
        }
        orl_lit_scene_free(lit_scene);
    }
    print_message("%zu of %zu faults are named\n", named, all);
    assert_true((double)named >= 0.95 * (double)all);
    orl_thread_pool_stop(pool);
}

static void test_sound_rooms(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    size_t alarms = 0, all = 0;
    (void)state;
    for (size_t f = 0; f < FAULTS; f++)
        for (uint64_t seed = 1; seed <= extent(4, 17); seed++, all++) {
            struct orl_result r =
                run_scene(faults[f].whole, ORL_EFFECT_COUNT, techniques[seed % 2], seed);
            if (r.cross_check.sensors_off > 0)
                print_message("%s, seed %d: %s\n", faults[f].name, (int)seed,
                              r.warnings[r.n_warnings - 1]);
            alarms += r.cross_check.sensors_off > 0;
            orl_result_done(&r);
        }
    print_message("%zu alarms in %zu sound rooms\n", alarms, all);
    assert_true(alarms <= extent(0, 1)); /* 1 % of 102, and of 24 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_faults),
                                       cmocka_unit_test(test_sound_rooms)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
