/*
 * The first plan of a job predicts the time that an accuracy takes, or gives the reason why it
 * cannot. A slow machine runs no pilot for the prediction, but its plan gives the reason, too. The
 * tests set the machine's speed by a clock of their own.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>
#include <oriel/base/thread_pool.h>
#include <oriel/job/skies.h>

#include "support/cli.h"
#include "support/scratch.h"

static const char plain[] =
    "void plastic grey 0 0 5 .5 .5 .5 0 0\nvoid glow sky_glow 0 0 4 10 10 10 0\n"
    "sky_glow source sky 0 0 4 0 0 1 180\n"
    "grey polygon floor 0 0 12 0 0 0  3 0 0  3 4 0  0 4 0\n"
    "grey polygon west 0 0 12 0 0 0  0 4 0  0 4 3  0 0 3\n";

/* Lobes within 2 degrees of the mirrored direction, on a wall beside the floor. */
static const char gloss[] = "void metfunc gloss 2 lobe l.cal 0 4 .8 .6 .4 .5\n"
                            "gloss polygon east 0 0 12 3 0 0  3 0 3  3 4 3  3 4 0\n";
static const char lobes[] =
    "m(x,y,z) = x*(Dx + 2*RdotP*NxP) + y*(Dy + 2*RdotP*NyP) + z*(Dz + 2*RdotP*NzP);\n"
    "lobe(x,y,z,o) = if(m(x,y,z) - .9995, 100, 0);\n";

/* The resulting plan, and the state of the clock. */
struct planned {
    double step_s, now;
    unsigned plans;
    bool has_curve;
    struct orl_accuracy_curve curve;
};

static double now_s(void *ctx)
{
    struct planned *planned = ctx;
    return planned->now += planned->step_s;
}

static int record_plan(void *ctx, const char *sky, const struct orl_result *result,
                       const struct orl_accuracy_curve *curve, struct orl_error *err)
{
    struct planned *planned = ctx;
    (void)sky, (void)result, (void)err;
    planned->plans++;
    planned->has_curve = curve != NULL;
    if (curve)
        planned->curve = *curve;
    return 0;
}

/* Plans a job of the scene on a machine whose clock advances by step_s per reading. */
static struct planned plan(const char *wall, double step_s)
{
    char *names[] = {(char[]){"room.rad"}};
    struct orl_sensor sensors[] = {{{1.5, 1, 0.8}, {0, 0, 1}}};
    const struct orl_job job = {.scene_files = names,
                                .n_scene_files = 1,
                                .sensors = sensors,
                                .n_sensors = 1,
                                .seed = 1,
                                .photons_global = 20000,
                                .gather_samples = 64};
    const struct orl_files files = orl_files_from_folder(scratch_path(""));
    struct planned planned = {.step_s = step_s};
    atomic_bool cancel = false;
    const struct orl_run_env env = {.pool = orl_thread_pool_start(1),
                                    .files = &files,
                                    .output_folder = scratch_path(""),
                                    .cancel = &cancel,
                                    .now_s = now_s,
                                    .ctx = &planned};
    struct orl_error err = {0};
    char scene[1024];
    snprintf(scene, sizeof scene, "%s%s", plain, wall);
    cli_write_file(scratch_path(""), "room.rad", scene);
    cli_write_file(scratch_path(""), "l.cal", lobes);
    if (orl_plan_skies(&job, &env, 1, record_plan, &planned, &err) < 0)
        fail_msg("%s", err.message);
    orl_thread_pool_stop(env.pool);
    assert_int_equal(planned.plans, 1);
    return planned;
}

/* Steps of the clock: planning reads it often, and takes over 20 s with the slow one. */
static const double fast_s = 1e-6, slow_s = 30;

static void test_fast(void **state)
{
    (void)state;
    const struct planned planned = plan("", fast_s);
    assert_true(planned.has_curve && planned.curve.n_points > 0);
}

static void test_slow(void **state)
{
    (void)state;
    assert_false(plan("", slow_s).has_curve);
}

static void test_narrow_lobes(void **state)
{
    (void)state;
    for (int slow = 0; slow < 2; slow++) {
        const struct planned planned = plan(gloss, slow ? slow_s : fast_s);
        assert_true(planned.has_curve);
        assert_int_equal(planned.curve.n_points, 0);
        assert_int_equal(planned.curve.threads, 1);
        assert_non_null(
            strstr(planned.curve.model, "not known: lobes of some materials are too narrow"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_fast, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_slow, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_narrow_lobes, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
