/*
 * The cross-check of sensors by plain path tracing (run/diagnostics/cross_check.c): right, too low
 * and too high values, in a room with a window and in one that also has a ball of glass. The true
 * values are from the oracle (support/brute.h).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/job/paths.h>

#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "support/brute.h"
#include "support/path_cells.h"
#include "support/scene_text.h"

#define BALL                                                                                       \
    "void dielectric crystal2 0 0 5 1 1 1 1.5 0\ncrystal2 sphere ball2 0 0 4 3.4 3.4 .4 .3\n"

enum { SKY = 1, OPENING = 0 };

static double now_s(void *ctx)
{
    (void)ctx;
    return 0;
}

struct bench {
    uint32_t paths; /* path classes that the planner has found */
    struct orl_thread_pool *pool;
    struct orl_lit_scene *lit_scene;
    struct brute_value truth[PATH_SENSORS];
};

static struct bench set_up(const char *more)
{
    char text[PATH_TEXT];
    struct bench b = {.pool = orl_thread_pool_start(1)};
    assert_true(path_cell_scene(SKY, OPENING, text));
    assert_true(strlen(text) + strlen(more) < sizeof text);
    strcat(text, more);
    b.lit_scene = build_lit_scene(text, "pane.xml", path_pane(), b.pool);
    brute_sensors(b.lit_scene, path_sensors, PATH_SENSORS, 200000, b.pool, b.truth);
    return b;
}

static void tear_down(struct bench *b)
{
    orl_lit_scene_free(b->lit_scene);
    orl_thread_pool_stop(b->pool);
}

/* Checks the true values times a factor, with intervals of 2 % to each side. */
static struct orl_result check_values(struct bench *b, double factor, uint64_t seed)
{
    struct orl_job job;
    struct orl_error err = {0};
    atomic_bool cancel;
    struct orl_result result = {.outcome = {.asked = true, .met = true}};
    atomic_init(&cancel, false);
    orl_job_init(&job);
    job.seed = seed;
    result.plan.technique = ORL_TECHNIQUE_GATHER;
    result.plan.most_reflections = ORL_ALL_REFLECTIONS;
    result.plan.paths = b->paths;
    result.n_sensors = PATH_SENSORS;
    result.illuminance_lx = calloc(PATH_SENSORS, sizeof(double));
    result.interval_95_lx = calloc(PATH_SENSORS, sizeof *result.interval_95_lx);
    assert_true(result.illuminance_lx && result.interval_95_lx);
    for (int i = 0; i < PATH_SENSORS; i++) {
        const double lx = b->truth[i].mean * factor;
        result.illuminance_lx[i] = lx;
        result.interval_95_lx[i][0] = 0.98 * lx;
        result.interval_95_lx[i][1] = 1.02 * lx;
    }
    const struct orl_run_env env = {.pool = b->pool, .cancel = &cancel, .now_s = now_s};
    struct orl_run_state state = {.job = &job,
                                  .env = &env,
                                  .result = &result,
                                  .sensors = (struct orl_sensor *)(uintptr_t)path_sensors,
                                  .n_sensors = PATH_SENSORS,
                                  .lit_scene = b->lit_scene,
                                  .samples = 1 << 20};
    assert_int_equal(orl_run_cross_check(&state, &err), 0);
    orl_run_apply_unreliable(&state);
    return result;
}

static size_t count_doubts(const struct orl_result *r)
{
    size_t n = 0;
    for (size_t i = 0; r->doubts && i < r->n_sensors; i++)
        n += r->doubts[i] == ORL_DOUBT_CROSS_CHECK;
    return n;
}

static void test_right_values(void **state)
{
    struct bench b = set_up("");
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        struct orl_result r = check_values(&b, 1, seed);
        assert_int_equal(r.cross_check.sensors_off, 0);
        assert_int_equal(r.n_warnings, 0);
        assert_null(r.doubts);
        assert_true(r.outcome.met);
        assert_true(r.cross_check.sensors >= 3);
        assert_true(fabs(r.cross_check.ratio - 1) < 4.5 * r.cross_check.ratio_error);
        orl_result_done(&r);
    }
    tear_down(&b);
}

/* If enough paths are known, the interval contains the truth. Of some 80 intervals of 95 % each,
 * fewer than 87 % do so once in a thousand times by chance. */
static void check_wrong(struct bench *b, double factor)
{
    size_t off = 0, held = 0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        struct orl_result r = check_values(b, factor, seed);
        for (int i = 0; i < PATH_SENSORS; i++)
            held += r.doubts && r.doubts[i] && r.interval_95_lx[i][0] <= b->truth[i].mean &&
                    b->truth[i].mean <= r.interval_95_lx[i][1];
        assert_true(r.cross_check.sensors_off >= 3);
        off += r.cross_check.sensors_off;
        assert_int_equal(r.n_warnings, 1);
        assert_non_null(strstr(r.warnings[0], "cross-check"));
        assert_int_equal(count_doubts(&r), r.cross_check.sensors_off);
        assert_false(r.outcome.met);
        assert_non_null(strstr(r.outcome.why, "unreliable"));
        orl_result_done(&r);
    }
    assert_true((double)held >= 0.87 * (double)off);
}

static void test_values_too_low(void **state)
{
    struct bench b = set_up("");
    (void)state;
    check_wrong(&b, 0.5);
    tear_down(&b);
}

static void test_values_too_high(void **state)
{
    struct bench b = set_up("");
    (void)state;
    check_wrong(&b, 2);
    tear_down(&b);
}

/* Path tracing misses light that a ball of glass focuses: lower values of paths are no evidence. */
static void test_where_light_is_bent(void **state)
{
    struct bench b = set_up(BALL);
    b.paths = 1U << ORL_PATHS_SKY_CURVED;
    (void)state;
    struct orl_result r = check_values(&b, 2, 1);
    assert_int_equal(r.cross_check.sensors_off, 0);
    assert_int_equal(r.n_warnings, 0);
    orl_result_done(&r);
    r = check_values(&b, 0.5, 1);
    assert_true(r.cross_check.sensors_off >= 3);
    orl_result_done(&r);
    tear_down(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_right_values),
        cmocka_unit_test(test_values_too_low),
        cmocka_unit_test(test_values_too_high),
        cmocka_unit_test(test_where_light_is_bent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
