/*
 * Predicted costs of tasks, from which Slurm's time limits are made: within a factor of several of
 * the real costs, also if the errors of an accuracy job are not yet known.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include <oriel/job/skies.h>

#include "support/cli.h"
#include "support/room.h"
#include "support/year.h"

/* The margin of the limits (slurm_limits.c), and the greatest allowed overestimate. */
static const double least = 1.0 / 8, most = 60;

struct fixture {
    char folder[64], kept[64];
    const char *kind;
    size_t n;                /* requested tasks of that kind */
    double core_s, first_s;  /* CPU seconds of all of them, and of the first */
    double began_s, until_s; /* annual runs: start, and the time until its sensors are requested */
};

static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the CPU time of this process; other processes do not count. */
static double cpu_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int divide_pieces(void *ctx, const struct orl_job_task *tasks, size_t n, bool *ret_here,
                         const struct orl_job_tasks_watch *watch, struct orl_error *err)
{
    struct fixture *f = ctx;
    (void)watch, (void)err;
    for (size_t i = 0; i < n; i++) {
        ret_here[i] = true;
        assert_true(tasks[i].core_s > 0);
        if (strcmp(tasks[i].kind, "rows") == 0)
            f->until_s = cpu_s();
        if (strcmp(tasks[i].kind, f->kind) != 0)
            continue;
        f->first_s = f->n++ > 0 ? f->first_s : tasks[i].core_s;
        f->core_s += tasks[i].core_s;
    }
    return 0;
}

static void assert_within(const struct fixture *f, double took_s)
{
    const double times = f->core_s / took_s;
    assert_true(f->n > 0);
    print_message("%s: %.2f s are foreseen, %.2f s were taken\n", f->kind, f->core_s, took_s);
    if (times < least || times > most)
        fail_msg("%s: %g s are foreseen, and %g s were taken", f->kind, f->core_s, took_s);
}

static int on_sky_done(void *ctx, size_t index, const struct orl_result *result,
                       struct orl_error *err)
{
    (void)ctx, (void)index, (void)err;
    assert_true(result->outcome.asked);
    return 0;
}

static void fill_skies(struct orl_named_sky skies[2])
{
    static char low[] = "low", high[] = "high";
    for (int i = 0; i < 2; i++) {
        orl_sky_request_init(&skies[i].request);
        skies[i].request.model = ORL_SKY_BY_PEREZ;
        skies[i].request.sun_given = true;
        skies[i].request.sun_altitude_deg = 20 + 30 * i;
        skies[i].request.first = 700;
        skies[i].request.second = 120;
    }
    skies[0].name = low;
    skies[1].name = high;
}

static void run_skies(struct fixture *f, enum orl_technique technique, double relative_error)
{
    static const char scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static char file[] = "room.rad", *names[] = {file};
    const char *const known[] = {file};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL}};
    struct orl_memory_files memory = {known, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_sensor sensors[20];
    struct orl_named_sky skies[2];
    struct orl_shared_store state = {.folder = ""};
    struct orl_map_store store;
    struct orl_error err = {0};
    struct orl_job job;
    const struct orl_job_tasks tasks = {f, "a job", divide_pieces, NULL};
    atomic_bool cancel = false;
    orl_job_init(&job);
    fill_skies(skies);
    for (int i = 0; i < 20; i++)
        sensors[i] = (struct orl_sensor){{0.5 + 0.7 * (i % 5), 0.5 + i / 5, 0.8}, {0, 0, 1}};
    job.scene_files = names;
    job.n_scene_files = 1;
    job.technique = technique;
    job.goal.relative_error = relative_error;
    job.goal.at = 0.95;
    job.sensors = sensors;
    job.n_sensors = 20;
    job.skies = skies;
    job.n_skies = 2;
    snprintf(state.folder, sizeof state.folder, "%s", f->kept);
    orl_shared_store_init(&state, &store);
    const struct orl_run_env env = {.pool = orl_thread_pool_start(1),
                                    .files = &files,
                                    .store = &store,
                                    .tasks = &tasks,
                                    .output_folder = f->folder,
                                    .cancel = &cancel,
                                    .now_s = now_s,
                                    .ctx = f};
    const struct orl_skies_env under = {.ctx = f, .done = on_sky_done};
    const double before = cpu_s();
    if (orl_run_skies(&job, &env, &under, &err) < 0)
        fail_msg("%s", err.message);
    assert_within(f, cpu_s() - before);
    orl_thread_pool_stop(env.pool);
    orl_shared_store_done(&state);
}

static void test_skies_by_maps_with_an_accuracy(void **state)
{
    struct fixture *f = *state;
    f->kind = "sky";
    run_skies(f, ORL_TECHNIQUE_GATHER, 0.1);
}

static void test_skies_by_paths_with_an_accuracy(void **state)
{
    struct fixture *f = *state;
    f->kind = "sky";
    run_skies(f, ORL_TECHNIQUE_BACKWARD, 0.02);
}

/* Runs the year's suns, with the light they send into the room. */
static void run_year(struct fixture *f, enum orl_annual_technique technique)
{
    static const struct orl_sensor sensors[] = {{{2, 2, 0.8}, {0, 0, 1}}};
    const struct orl_job_tasks tasks = {f, "a job", divide_pieces, NULL};
    const struct year_run run = {.scene = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                                 .site = {50, 10, 1},
                                 .sensors = sensors,
                                 .n_sensors = 1,
                                 .samples = 64,
                                 .technique = technique,
                                 .kept_in = f->kept,
                                 .tasks = &tasks};
    struct orl_annual_result year;
    f->kind = "annual";
    f->began_s = cpu_s();
    year = year_run(&run);
    assert_int_equal(f->n, 2);
    f->core_s = f->first_s; /* CPU seconds of the suns, which make the map */
    assert_within(f, f->until_s - f->began_s);
    orl_annual_done(&year);
}

static void test_the_suns_of_a_year(void **state)
{
    run_year(*state, ORL_ANNUAL_BY_PATHS);
}

static void test_the_suns_of_a_precomputed_year(void **state)
{
    run_year(*state, ORL_ANNUAL_PRECOMPUTED);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    cli_make_folder(f->folder);
    cli_make_folder(f->kept);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    cli_remove_folder(f->folder);
    cli_remove_folder(f->kept);
    free(f);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_skies_by_maps_with_an_accuracy, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_skies_by_paths_with_an_accuracy, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_suns_of_a_year, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_suns_of_a_precomputed_year, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
