/*
 * A job with sensors and views that leaves the technique to the planner: sensors are rendered by
 * paths and views by photon maps, each as if the job had nothing else.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"
#include "support/scratch.h"

#define VIEW "-vtv -vp 2 3.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 60"
#define DARK_VIEW "-vtv -vp 3.2 3.2 .2 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 60"

static const struct orl_sensor sensors[] = {
    {{1, 1, 0.8}, {0, 0, 1}}, {{2, 2, 0.8}, {0, 0, 1}}, {{3, 1.5, 1.2}, {0, -1, 0}}};
static const struct orl_sensor in_cupboard[] = {{{3.2, 3.2, 0.2}, {0, 0, 1}}};
enum { SENSORS = sizeof sensors / sizeof *sensors };

static struct scene_run base(void)
{
    return (struct scene_run){.scene = scene_fixture("room_ribbon_window"),
                              .by_plan = true,
                              .samples = 256,
                              .global = 20000,
                              .caustic = 1};
}

static struct scene_run with_sensors(struct scene_run run)
{
    run.sensors = sensors;
    run.n_sensors = SENSORS;
    return run;
}

static struct scene_run with_view(struct scene_run run)
{
    run.view = VIEW;
    run.width = run.height = 24;
    return run;
}

static struct scene_run with_both(void)
{
    return with_view(with_sensors(base()));
}

/* A job with a goal instead of samples and photons. */
static struct scene_run both_with_goal(struct orl_goal goal)
{
    struct scene_run run = with_view(with_sensors((struct scene_run){
        .scene = scene_fixture("room_ribbon_window"), .by_plan = true, .goal = goal}));
    run.goal.at = 0.95;
    return run;
}

/* Renders into a separate folder, without cached maps; returns the picture. */
static unsigned char *picture_of(struct scene_run run, const char *folder,
                                 struct orl_result *ret_result, size_t *ret_size)
{
    char picture[64];
    snprintf(picture, sizeof picture, "%s/view.hdr", folder);
    run.folder = scratch_path(folder);
    assert_int_equal(mkdir(run.folder, 0700), 0);
    *ret_result = scene_run(&run);
    return scene_read_bytes(scratch_path(picture), ret_size);
}

/*
 * Sensors have the same bytes as in a job without views, and the picture as in one without sensors.
 */
static void test_results_are_those_of_separate_jobs(void **state)
{
    const struct scene_run only_sensors = with_sensors(base());
    struct orl_result both, view, alone = scene_run(&only_sensors);
    size_t size, size_alone;
    unsigned char *picture = picture_of(with_both(), "both", &both, &size);
    unsigned char *picture_alone = picture_of(with_view(base()), "view", &view, &size_alone);
    (void)state;
    assert_int_equal(both.plan.technique, ORL_TECHNIQUE_GATHER);
    assert_int_equal(both.plan.sensor_technique, ORL_TECHNIQUE_BACKWARD);
    assert_string_equal(both.plan.sensor_why, alone.plan.technique_why);
    assert_string_equal(both.plan.technique_why, view.plan.technique_why);
    assert_int_equal(both.n_sensors, SENSORS);
    assert_int_equal(both.n_views, 1);
    assert_memory_equal(both.illuminance_lx, alone.illuminance_lx, SENSORS * sizeof(double));
    assert_memory_equal(both.standard_error_lx, alone.standard_error_lx, SENSORS * sizeof(double));
    assert_memory_equal(both.interval_95_lx, alone.interval_95_lx,
                        SENSORS * sizeof *both.interval_95_lx);
    assert_int_equal(both.cross_check.paths, alone.cross_check.paths);
    assert_int_equal(size, size_alone);
    assert_memory_equal(picture, picture_alone, size);
    assert_int_equal(both.health.surfaces, alone.health.surfaces);
    assert_int_equal(both.health.rays, alone.health.rays + view.health.rays);
    assert_int_equal(both.cost.rays, alone.cost.rays + view.cost.rays);
    free(picture);
    free(picture_alone);
    orl_result_done(&both);
    orl_result_done(&view);
    orl_result_done(&alone);
}

/* One technique is used for both if the job names it, or if a deadline divides the time. */
static void test_one_technique_for_both(void **state)
{
    struct scene_run named = with_both();
    const struct scene_run timed = both_with_goal((struct orl_goal){.deadline_s = 0.5});
    (void)state;
    named.by_plan = false;
    named.technique = ORL_TECHNIQUE_GATHER;
    struct orl_result results[] = {scene_run(&named), scene_run(&timed)};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(results[i].plan.technique, ORL_TECHNIQUE_GATHER);
        assert_int_equal(results[i].plan.sensor_technique, ORL_TECHNIQUE_GATHER);
        assert_int_equal(results[i].n_sensors, SENSORS);
        orl_result_done(&results[i]);
    }
}

/* Both are rendered to the accuracy; the sensors are known after a round of views. */
struct rounds {
    uint32_t count, with_sensors;
};
static void note_round(void *ctx, const struct orl_result *result)
{
    struct rounds *rounds = ctx;
    rounds->count++;
    rounds->with_sensors += result->n_sensors == SENSORS && result->illuminance_lx[0] > 0;
}

static void test_an_accuracy_of_both(void **state)
{
    struct rounds rounds = {0, 0};
    struct scene_run run = both_with_goal((struct orl_goal){.relative_error = 0.1});
    (void)state;
    run.round_ready = note_round;
    run.ctx = &rounds;
    struct orl_result r = scene_run(&run);
    assert_true(r.outcome.asked && r.outcome.met);
    assert_int_equal(r.plan.sensor_technique, ORL_TECHNIQUE_BACKWARD);
    assert_true(rounds.count > 0 && rounds.with_sensors == rounds.count);
    assert_true(r.outcome.rounds >= rounds.count);
    assert_true(r.outcome.achieved <= 0.1);
    for (int i = 0; i < SENSORS; i++)
        assert_true(r.standard_error_lx[i] < 0.1 * r.illuminance_lx[i]);
    orl_result_done(&r);
}

/* The job's fraction never decreases, and stays below 1 until the end. */
struct course {
    double share;
    uint32_t falls, early;
};
static void note_progress(void *ctx, enum orl_stage stage, double stage_fraction,
                          double job_fraction, double left_s)
{
    struct course *course = ctx;
    (void)stage, (void)stage_fraction, (void)left_s;
    course->falls += job_fraction < course->share;
    course->early += course->share >= 1;
    course->share = job_fraction;
}

static void test_progress_of_both(void **state)
{
    struct course course = {0};
    struct scene_run run = with_both();
    (void)state;
    run.progress = note_progress;
    run.ctx = &course;
    struct orl_result r = scene_run(&run);
    assert_true(course.share == 1);
    assert_int_equal(course.falls, 0);
    assert_int_equal(course.early, 0);
    orl_result_done(&r);
}

static bool warns_of(const struct orl_result *result, const char *text)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], text))
            return true;
    return false;
}

/* Dark sensors beside a view with light cause a warning; sensors and views that are all dark are an
 * error. */
static void test_darkness_of_both(void **state)
{
    struct scene_run run = with_both();
    struct orl_error err;
    (void)state;
    run.dark_is_error = true;
    run.sensors = in_cupboard;
    run.n_sensors = 1;
    struct orl_result r = scene_run(&run);
    assert_true(warns_of(&r, "1 of 1 sensors is at 0 lx"));
    orl_result_done(&r);
    run.view = DARK_VIEW;
    assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_UNLIT);
    assert_non_null(strstr(err.message, "all sensors (1) and views (1) are black"));
}

/* ---- Another technique after the cross-check ------------------------------------------------- */

static double no_clock(void *ctx)
{
    (void)ctx;
    return 0;
}

/* A sensor result that a cross-check rejects, made by fault injection. */
static struct orl_result faulty_result(void)
{
    struct orl_result r = {.n_sensors = SENSORS};
    r.plan.technique = r.plan.sensor_technique = ORL_TECHNIQUE_BACKWARD;
    r.illuminance_lx = calloc(SENSORS, sizeof(double));
    r.standard_error_lx = calloc(SENSORS, sizeof(double));
    r.bias_estimate_lx = calloc(SENSORS, sizeof(double));
    r.interval_95_lx = calloc(SENSORS, sizeof *r.interval_95_lx);
    r.doubts = calloc(SENSORS, 1);
    assert_true(r.illuminance_lx && r.standard_error_lx && r.bias_estimate_lx && r.interval_95_lx);
    assert_non_null(r.doubts);
    memset(r.doubts, ORL_DOUBT_CROSS_CHECK, SENSORS);
    r.cross_check.sensors_off = SENSORS;
    return r;
}

static struct orl_job sensor_job(enum orl_technique technique)
{
    static char name[] = "scene.rad", *names[] = {name};
    struct orl_job job;
    orl_job_init(&job);
    job.scene_files = names;
    job.n_scene_files = 1;
    job.technique = technique;
    job.photons_global = 20000;
    job.photons_caustic = 1;
    job.photons_exact = true;
    job.gather_samples = 256;
    job.sensors = (struct orl_sensor *)(uintptr_t)sensors;
    job.n_sensors = SENSORS;
    return job;
}

/* Runs the sensors of a faulty result again, for that job. */
static struct orl_result run_again(struct orl_job job)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene =
        build_lit_scene(scene_fixture("room_ribbon_window"), NULL, NULL, pool);
    struct orl_progress progress = {0};
    struct orl_error err;
    atomic_bool cancel;
    atomic_init(&cancel, false);
    const struct orl_run_env env = {.pool = pool, .cancel = &cancel, .now_s = no_clock};
    struct orl_result result = faulty_result();
    struct orl_run_state state = {.job = &job,
                                  .env = &env,
                                  .result = &result,
                                  .sensors = job.sensors,
                                  .n_sensors = SENSORS,
                                  .scene = lit_scene->scene,
                                  .lit_scene = lit_scene,
                                  .progress = &progress,
                                  .run_sensors = orl_run_only_sensors};
    orl_run_warn(&state, "of the scene");
    orl_run_warn(&state, "of the first technique");
    assert_int_equal(orl_sensor_run_retry(&state, 1, &err), 0);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_free(pool);
    return result;
}

/* The planned technique is replaced by the other one, whose values are correct. */
static void test_another_technique_after_the_cross_check(void **state)
{
    struct scene_run gather = with_sensors(base());
    (void)state;
    gather.technique = ORL_TECHNIQUE_GATHER;
    struct orl_result r = run_again(sensor_job(ORL_TECHNIQUE_AUTO)), truth = scene_run(&gather);
    assert_int_equal(r.plan.sensor_technique, ORL_TECHNIQUE_GATHER);
    assert_non_null(strstr(r.plan.sensor_why, "with backward, 3 of 3 sensors differed"));
    assert_memory_equal(r.illuminance_lx, truth.illuminance_lx, SENSORS * sizeof(double));
    assert_null(r.doubts);
    assert_int_equal(r.cross_check.sensors_off, 0);
    assert_true(warns_of(&r, "of the scene") && !warns_of(&r, "of the first technique"));
    orl_result_done(&r);
    orl_result_done(&truth);
}

/* A technique that the job names stays, with its doubts and its warnings. */
static void test_a_named_technique_stays(void **state)
{
    struct orl_result r = run_again(sensor_job(ORL_TECHNIQUE_BACKWARD));
    (void)state;
    assert_int_equal(r.plan.sensor_technique, ORL_TECHNIQUE_BACKWARD);
    assert_int_equal(r.cross_check.sensors_off, SENSORS);
    assert_non_null(r.doubts);
    assert_true(warns_of(&r, "of the first technique"));
    orl_result_done(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_results_are_those_of_separate_jobs, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test(test_one_technique_for_both),
        cmocka_unit_test(test_an_accuracy_of_both),
        cmocka_unit_test(test_progress_of_both),
        cmocka_unit_test(test_darkness_of_both),
        cmocka_unit_test(test_another_technique_after_the_cross_check),
        cmocka_unit_test(test_a_named_technique_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
