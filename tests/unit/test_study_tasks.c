/*
 * Distributed studies: runs of other processes, in any order, give the numbers of a study in one
 * process, with the times measured by those processes.
 */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include <oriel/job/study.h>

#include "support/cli.h"
#include "support/room.h"

static const char scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_SKY;
static char scene_file[] = "room.rad";
static char *scene_files[] = {scene_file};
enum { OTHERS = 3, REFERENCE = 3, REPEATS = 2, SETTINGS = 3 };
enum { RUNS = REFERENCE + SETTINGS * REPEATS };

/* A folder of tasks, and the role of this process. */
struct fixture {
    char tasks[64], work[64];
    atomic_bool cancel;
    double haste; /* speed factor of the clock */
    int mine; /* the tasks that this process computes; OTHERS: it coordinates, and computes none */
    bool begun;   /* true if it has computed its own tasks */
    size_t asked; /* number of tasks that the coordinating process requested */
    size_t spent, points, in_parts;
    struct orl_error err;
};

static double now_s(void *ctx)
{
    const struct fixture *f = ctx;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return f->haste * ((double)t.tv_sec + 1e-9 * (double)t.tv_nsec);
}

static void on_spent(void *ctx, const struct orl_result *spent)
{
    struct fixture *f = ctx;
    assert_true(spent->total_s > 0);
    assert_true(spent->health.rays > 0);
    f->spent++;
}

static void on_point(void *ctx, const struct orl_study_point *point)
{
    (void)point;
    ((struct fixture *)ctx)->points++;
}

static void on_progress(void *ctx, const struct orl_study_step *step)
{
    struct fixture *f = ctx;
    assert_true(step->fraction >= 0 && step->fraction <= 1);
    assert_true(step->run >= 1 && step->run <= step->runs);
    f->in_parts += strcmp(orl_study_step_name(step), "parts") == 0;
}

/* Claims tasks. A worker gets its share at the first call, and ORL_ERR_CANCELLED after that. The
 * coordinating process gets none: the call reports progress and counts the requested tasks. */
static int claim_pieces(void *ctx, const struct orl_job_task *tasks, size_t n, bool *ret_here,
                        const struct orl_job_tasks_watch *watch, struct orl_error *err)
{
    struct fixture *f = ctx;
    double work = 0;
    for (size_t i = 0; i < n; i++) {
        assert_true(tasks[i].work > 0 && tasks[i].core_s > 0);
        work += tasks[i].work;
        ret_here[i] = f->mine < OTHERS && tasks[i].key[0] % OTHERS == f->mine;
    }
    if (f->mine == OTHERS) {
        assert_non_null(watch);
        watch->reported(watch->ctx, 0.5);
        f->asked += n;
        return orl_error_set(err, ORL_ERR_CANCELLED, "nobody is there to make them");
    }
    if (f->begun)
        return orl_error_set(err, ORL_ERR_CANCELLED, "its own are made");
    assert_true(n <= RUNS + 1 && work > 0);
    f->begun = true;
    return 0;
}

static struct orl_study_request make_request(void)
{
    static enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_DIRECT};
    static uint64_t photons[] = {1000, 4000};
    static uint32_t samples[] = {64};
    static struct orl_sensor sensors[] = {{{2, 1, 0.8}, {0, 0, 1}}, {{2, 3, 0.8}, {0, 0, 1}}};
    struct orl_study_request request;
    orl_study_request_init(&request);
    request.job.scene_files = scene_files;
    request.job.n_scene_files = 1;
    request.job.seed = 7;
    request.job.sensors = sensors;
    request.job.n_sensors = 2;
    request.techniques = techniques;
    request.n_techniques = 2;
    request.photons = photons;
    request.n_photons = 2;
    request.samples = samples;
    request.n_samples = 1;
    request.repeats = REPEATS;
    request.reference_samples = 3000;
    request.reference_runs = REFERENCE;
    return request;
}

/* tasks is NULL for a study in one process. */
static int run_study(struct fixture *f, const struct orl_job_tasks *tasks,
                     struct orl_study *ret_study)
{
    const struct orl_study_request request = make_request();
    const char *const names[] = {scene_file};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_shared_store state = {.folder = ""};
    struct orl_map_store store;
    snprintf(state.folder, sizeof state.folder, "%s", f->tasks);
    orl_shared_store_init(&state, &store);
    const struct orl_study_env env = {.pool = orl_thread_pool_start(1),
                                      .files = &files,
                                      .work_folder = f->work,
                                      .tasks = tasks,
                                      .store = &store,
                                      .cancel = &f->cancel,
                                      .now_s = now_s,
                                      .progress = on_progress,
                                      .point_ready = on_point,
                                      .spent = on_spent,
                                      .ctx = f};
    f->spent = f->points = f->asked = f->in_parts = 0;
    f->begun = false;
    const int code = orl_study_run(&request, &env, ret_study, &f->err);
    orl_thread_pool_stop(env.pool);
    orl_shared_store_done(&state);
    return code;
}

static int run_as(struct fixture *f, int who, double haste, struct orl_study *ret_study)
{
    const struct orl_job_tasks tasks = {f, "a job", claim_pieces, NULL};
    f->mine = who;
    f->haste = haste;
    return run_study(f, &tasks, ret_study);
}

/* Runs all other processes in sequence; the last one finds all tasks computed. */
static void run_others(struct fixture *f, double haste)
{
    static const int order[OTHERS] = {2, 0, 1};
    for (size_t i = 0; i < OTHERS; i++) {
        struct orl_study study = {0};
        const int code = run_as(f, order[i], haste, &study);
        assert_int_equal(code, i + 1 < OTHERS ? ORL_ERR_CANCELLED : 0);
        assert_int_equal(f->points, i + 1 < OTHERS ? 0 : SETTINGS);
        orl_study_done(&study);
    }
}

static void assert_same(const struct orl_study *a, const struct orl_study *b)
{
    assert_int_equal(a->n_points, SETTINGS);
    assert_int_equal(b->n_points, SETTINGS);
    assert_int_equal(a->threads, b->threads);
    assert_true(a->reference.standard_error == b->reference.standard_error);
    assert_int_equal(a->reference.values, b->reference.values);
    for (size_t i = 0; i < SETTINGS; i++) {
        const struct orl_study_point *p = &a->points[i], *q = &b->points[i];
        assert_memory_equal(&p->setting, &q->setting, sizeof p->setting);
        assert_true(p->rms == q->rms && p->bias == q->bias && p->noise == q->noise);
        assert_true(p->p95 == q->p95 && p->rms_error == q->rms_error);
        assert_int_equal(p->map_bytes, q->map_bytes);
    }
    assert_int_equal(a->n_warnings, b->n_warnings);
    for (size_t i = 0; i < a->n_warnings; i++)
        assert_string_equal(a->warnings[i], b->warnings[i]);
}

/* Damages the first run's task file in the folder. */
static void damage_one(const struct fixture *f)
{
    DIR *entries = opendir(f->tasks);
    char path[400] = "";
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;)
        if (strncmp(entry->d_name, "run-", 4) == 0)
            snprintf(path, sizeof path, "%s/%s", f->tasks, entry->d_name);
    closedir(entries);
    assert_int_equal(truncate(path, 50), 0);
}

/* The others' clocks are so fast that their runs seem to take minutes; a run here does not. */
static void test_runs_are_made_by_others(void **state)
{
    struct fixture *f = *state;
    struct orl_study whole = {0}, merged = {0};
    f->haste = 1;
    assert_int_equal(run_study(f, NULL, &whole), 0);
    run_others(f, 100000);
    assert_int_equal(run_as(f, OTHERS, 1, &merged), 0);
    assert_int_equal(f->asked, 0);
    assert_int_equal(f->spent, RUNS);
    assert_int_equal(f->points, SETTINGS);
    assert_same(&whole, &merged);
    for (size_t i = 0; i < SETTINGS; i++)
        assert_true(merged.points[i].total_s > 60 && whole.points[i].total_s < 60);
    assert_true(merged.rays_per_s < whole.rays_per_s / 10);
    orl_study_done(&merged);
    orl_study_done(&whole);
}

/* A damaged task is requested once more, alone; tasks of another job are all requested. */
static void test_a_damaged_run_is_made_again(void **state)
{
    struct fixture *f = *state;
    struct orl_study merged = {0};
    run_others(f, 1);
    damage_one(f);
    assert_int_equal(run_as(f, OTHERS, 1, &merged), ORL_ERR_CANCELLED);
    assert_int_equal(f->asked, 1);
    assert_true(f->in_parts > 0);
    const struct orl_job_tasks tasks = {f, "another job", claim_pieces, NULL};
    assert_int_equal(run_study(f, &tasks, &merged), ORL_ERR_CANCELLED);
    assert_int_equal(f->asked, RUNS + 1);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    cli_make_folder(f->tasks);
    cli_make_folder(f->work);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    cli_remove_folder(f->tasks);
    cli_remove_folder(f->work);
    free(f);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_runs_are_made_by_others, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_damaged_run_is_made_again, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
