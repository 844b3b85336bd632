/*
 * Small complete studies: a room with a window under a uniform sky. Errors, times and files are
 * tested for properties that hold for any numbers.
 */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include <oriel/job/study.h>

#include "support/cli.h"
#include "support/extent.h"
#include "support/room.h"

static const char scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_SKY;
static char scene_file[] = "room.rad";
static char *scene_files[] = {scene_file};
static char view_name[] = "view", view_text[] = "-vtv -vp 2 1 1.5 -vd 0 1 0 -vh 60 -vv 60";

static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Reports of a study. */
struct witness {
    atomic_bool cancel;
    size_t calls, points, cancel_after, runs;
    struct orl_health health; /* counters summed over all runs */
    double last;
    bool fell;
};

static void on_progress(void *ctx, const struct orl_study_step *step)
{
    struct witness *w = ctx;
    assert_true(step->fraction >= 0 && step->fraction <= 1 + 1e-9);
    assert_true(step->run >= 1 && step->run <= step->runs);
    assert_int_equal(step->reference, strcmp(orl_study_step_name(step), "reference") == 0);
    assert_false(step->reference && w->points > 0);
    w->fell = w->fell || step->fraction < w->last - 1e-9;
    w->last = step->fraction;
    w->calls++;
}

static void on_point(void *ctx, const struct orl_study_point *point)
{
    struct witness *w = ctx;
    assert_true(point->seeds > 0);
    w->points++;
    if (w->points == w->cancel_after)
        atomic_store(&w->cancel, true);
}

static void on_spent(void *ctx, const struct orl_result *spent)
{
    struct witness *w = ctx;
    assert_true(spent->total_s > 0);
    orl_health_add(&w->health, &spent->health);
    w->runs++;
}

static int run_study(const struct orl_study_request *request, uint32_t threads,
                     struct witness *witness, struct orl_study *ret_study, struct orl_error *err)
{
    const char *const names[] = {scene_file};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    char folder[64];
    cli_make_folder(folder);
    const struct orl_study_env env = {.pool = orl_thread_pool_start(threads),
                                      .files = &files,
                                      .work_folder = folder,
                                      .cancel = &witness->cancel,
                                      .now_s = now_s,
                                      .progress = on_progress,
                                      .point_ready = on_point,
                                      .spent = on_spent,
                                      .ctx = witness};
    const int code = orl_study_run(request, &env, ret_study, err);
    orl_thread_pool_stop(env.pool);
    /* Runs leave no files behind, however the study ended. */
    DIR *left = opendir(folder);
    size_t entries = 0;
    assert_non_null(left);
    while (readdir(left))
        entries++;
    closedir(left);
    assert_int_equal(entries, 2);
    cli_remove_folder(folder);
    return code;
}

/* The caller owns the arrays: do not call orl_study_request_done. */
static struct orl_study_request make_request(void)
{
    static enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    static uint64_t photons[] = {2000, 30000};
    static uint32_t samples[] = {32, 512};
    static struct orl_study_external external[] = {
        {.name = view_name, .seconds = 3, .rms = 0.1, .rays_per_s = 1000},
        {.name = view_name, .seconds = 3, .rms = 0.1}};
    struct orl_study_request r;
    samples[0] = 32; /* a test may have changed it */
    orl_study_request_init(&r);
    r.job.scene_files = scene_files;
    r.job.n_scene_files = 1;
    r.job.sensors = (struct orl_sensor *)(uintptr_t)room_sensors;
    r.job.n_sensors = ROOM_SENSORS;
    r.techniques = techniques;
    r.n_techniques = 2;
    r.photons = photons;
    r.n_photons = 2;
    r.samples = samples;
    r.n_samples = 2;
    r.repeats = 4;
    r.reference_samples = (uint32_t)extent(32768, 65536);
    r.reference_runs = 4;
    r.external = external;
    r.n_external = 2;
    return r;
}

static void assert_point(const struct orl_study_point *p)
{
    double sum = 0;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        sum += p->stages_s[i];
    assert_true(p->total_s > 0 && fabs(sum - p->total_s) < 0.1 * p->total_s);
    assert_true(p->rms > 0 && p->rms < 1 && p->rms_error >= 0);
    assert_true(fabs(p->bias) <= p->rms + 3 * p->bias_error);
    assert_true(p->noise > 0 && p->p95 > 0);
    /* Maps were made, in every run of photons and in no other. */
    assert_int_equal(p->map_bytes > 0, p->setting.technique == ORL_TECHNIQUE_GATHER);
}

static void test_sensors(void **state)
{
    const struct orl_study_request request = make_request();
    struct witness w = {.last = 0};
    struct orl_study study = {0};
    (void)state;
    assert_int_equal(run_study(&request, 2, &w, &study, NULL), 0);
    /* Backward by samples, gather by photons and samples. */
    assert_int_equal(study.n_points, 2 + 4);
    assert_int_equal(w.points, study.n_points);
    assert_false(w.fell);
    assert_true(w.calls > 10 && w.last > 0.99);
    for (size_t i = 0; i < study.n_points; i++)
        assert_point(&study.points[i]);
    assert_int_equal(study.reference.values + study.reference.left_out, ROOM_SENSORS);
    assert_true(study.reference.values > 0 && study.reference.worst <= 0.01);
    /* Sixteen times the samples: a quarter of the noise, which the spread of 4 seeds at 5 sensors
     * measures to a factor of 2. */
    assert_true(study.points[1].rms < 0.5 * study.points[0].rms);
    assert_int_equal(study.n_fits, 2);
    assert_true(study.fits[0].terms[ORL_FIT_SAMPLES] > 0);
    assert_int_equal(study.n_external, 2);
    assert_string_equal(study.external[0].name, request.external[0].name);
    /* Three seconds of a machine a thousand times slower, and of an unknown one. */
    assert_true(study.rays_per_s > 1000);
    assert_true(fabs(study.external[0].here_s - 3000 / study.rays_per_s) < 1e-9);
    assert_true(study.external[1].here_s == 3);
    orl_study_done(&study);
}

/* The numbers, except times, are equal for any number of threads; the seeds are the request's. */
static void test_errors_do_not_depend_on_threads(void **state)
{
    struct orl_study_request request = make_request();
    struct orl_study one = {0}, three = {0};
    struct witness w = {.last = 0}, v = {.last = 0};
    (void)state;
    request.n_samples = 1;
    request.repeats = 2;
    request.reference_samples = 4096;
    assert_int_equal(run_study(&request, 1, &w, &one, NULL), 0);
    assert_int_equal(run_study(&request, 3, &v, &three, NULL), 0);
    assert_int_equal(one.n_points, three.n_points);
    for (size_t i = 0; i < one.n_points; i++) {
        assert_true(one.points[i].rms == three.points[i].rms);
        assert_true(one.points[i].bias == three.points[i].bias);
        assert_true(one.points[i].map_bytes == three.points[i].map_bytes);
    }
    orl_study_done(&one);
    orl_study_done(&three);
}

static void test_views(void **state)
{
    struct orl_view_request view = {
        .name = view_name, .view = view_text, .width = 24, .height = 16};
    struct orl_study_request request = make_request();
    struct witness w = {.last = 0};
    struct orl_study study = {0};
    (void)state;
    request.job.sensors = NULL;
    request.job.n_sensors = 0;
    request.job.views = &view;
    request.job.n_views = 1;
    request.samples[0] = 4;
    request.n_samples = 1;
    request.n_photons = 1;
    request.repeats = 2;
    request.reference_samples = 256;
    assert_int_equal(run_study(&request, 2, &w, &study, NULL), 0);
    assert_int_equal(study.n_points, 2);
    assert_true(study.of_views);
    assert_int_equal(study.reference.runs, 4);
    assert_int_equal(study.reference.values, 24 * 16);
    assert_true(study.reference.standard_error > 0);
    for (size_t i = 0; i < study.n_points; i++) {
        assert_point(&study.points[i]);
        assert_true(study.points[i].peak >= 0 && isfinite(study.points[i].peak));
    }
    /* Views of the gather technique ignore samples. */
    assert_int_equal(study.points[0].setting.samples, 4);
    assert_int_equal(study.points[1].setting.samples, 0);
    orl_study_done(&study);
}

static void test_cancelling(void **state)
{
    struct orl_study_request request = make_request();
    struct witness w = {.cancel_after = 2};
    struct orl_study study = {0};
    struct orl_error err = {0};
    (void)state;
    request.reference_samples = 4096;
    assert_int_equal(run_study(&request, 1, &w, &study, &err), ORL_ERR_CANCELLED);
    assert_int_equal(w.points, 2);
    assert_null(study.points);
    /* The interrupted run reports its cost, like those before it. */
    assert_int_equal(w.runs, request.reference_runs + 2 * request.repeats + 1);
    assert_true(w.health.rays > 0 && w.health.photons > 0);
}

static void test_failures_are_the_runs_own(void **state)
{
    static char missing[] = "missing.rad";
    char *files[] = {missing};
    struct orl_study_request request = make_request();
    struct witness w = {.last = 0};
    struct orl_study study = {0};
    struct orl_error err = {0};
    (void)state;
    request.job.scene_files = files;
    assert_int_equal(run_study(&request, 1, &w, &study, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, missing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sensors),
        cmocka_unit_test(test_errors_do_not_depend_on_threads),
        cmocka_unit_test(test_views),
        cmocka_unit_test(test_cancelling),
        cmocka_unit_test(test_failures_are_the_runs_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
