/*
 * Jobs with an accuracy or a deadline in a sunny room: their accuracy compared with long runs of
 * the unbiased technique; that they end; and that accuracies depend neither on threads nor on time.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "support/cli.h"
#include "support/hdr.h"
#include "support/room.h"
#include "support/scene_text.h"

static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;

static struct scene_run job(enum orl_technique technique, double relative_error, uint64_t seed)
{
    return (struct scene_run){.scene = scene,
                              .sensors = room_sensors,
                              .n_sensors = ROOM_SENSORS,
                              .technique = technique,
                              .seed = seed,
                              .goal = {.relative_error = relative_error, .at = 0.95}};
}

/* Uses 2 x 16384 samples: standard errors of some 0.5 %, small beside 5 %. */
static void find_truth(double ret_lx[ROOM_SENSORS])
{
    struct scene_run run = {.scene = scene,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .technique = ORL_TECHNIQUE_BACKWARD,
                            .global = 400000,
                            .samples = 16384};
    memset(ret_lx, 0, ROOM_SENSORS * sizeof *ret_lx);
    for (run.seed = 1001; run.seed <= 1002; run.seed++) {
        struct orl_result r = scene_run(&run);
        for (size_t i = 0; i < ROOM_SENSORS; i++) {
            assert_true(r.standard_error_lx[i] < 0.01 * r.illuminance_lx[i]);
            ret_lx[i] += r.illuminance_lx[i] / 2;
        }
        orl_result_done(&r);
    }
}

/* Requires all five sensors, since 0.95 of five rounds up to all. */
static bool is_within(const struct orl_result *r, const double *truth, double target)
{
    for (size_t i = 0; i < ROOM_SENSORS; i++)
        if (!(fabs(r->illuminance_lx[i] - truth[i]) <= target * truth[i]))
            return false;
    return true;
}

/*
 * A goal is met with a probability of 0.975, of which checking after every round takes some. At
 * 0.95, fewer than 9 of 10 seeds are within it once in 12, fewer than 2 of 2 once in 10.
 */
static void test_accuracy_is_kept(void **state)
{
    static const struct {
        enum orl_technique technique;
        double target;
        int seeds, least;
    } cases[] = {{ORL_TECHNIQUE_BACKWARD, 0.05, 10, 9}, {ORL_TECHNIQUE_GATHER, 0.15, 2, 2}};
    double truth[ROOM_SENSORS];
    (void)state;
    find_truth(truth);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        int within = 0;
        for (int seed = 1; seed <= cases[c].seeds; seed++) {
            const struct scene_run run = job(cases[c].technique, cases[c].target, (uint64_t)seed);
            struct orl_result r = scene_run(&run);
            assert_true(r.outcome.asked && r.outcome.met && r.outcome.rounds > 0);
            assert_true(r.outcome.achieved <= cases[c].target);
            assert_true(r.cost.error == r.outcome.achieved);
            assert_true(r.cost.halve_s > r.total_s);
            within += is_within(&r, truth, cases[c].target);
            orl_result_done(&r);
        }
        if (within < cases[c].least)
            fail_msg("case %zu: %d of %d seeds are within %g", c, within, cases[c].seeds,
                     cases[c].target);
    }
}

/* Counts of rounds and the last stated error; a clock that advances by the number of its calls. */
struct watch {
    uint32_t rounds;
    double error, now, tick;
};

static double tick(void *ctx)
{
    struct watch *watch = ctx;
    return watch->now += watch->tick;
}

static void count_round(void *ctx, const struct orl_result *result)
{
    struct watch *watch = ctx;
    watch->rounds++;
    watch->error = result->outcome.achieved;
    assert_int_equal(result->outcome.rounds, watch->rounds);
    assert_int_equal(result->n_sensors, ROOM_SENSORS);
}

/* Neither threads nor an erratic clock change a bit. */
static void test_same_bytes(void **state)
{
    struct watch slow = {.tick = 1e-3}, wild = {.tick = 1000};
    struct scene_run run = job(ORL_TECHNIQUE_BACKWARD, 0.015, 1);
    (void)state;
    run.now_s = tick;
    run.round_ready = count_round;
    run.ctx = &slow;
    struct orl_result a = scene_run(&run);
    run.threads = 3;
    run.ctx = &wild;
    struct orl_result b = scene_run(&run);
    assert_true(slow.rounds >= 2);
    assert_int_equal(slow.rounds, wild.rounds);
    assert_true(slow.error == a.outcome.achieved);
    assert_true(a.outcome.achieved == b.outcome.achieved);
    assert_memory_equal(a.illuminance_lx, b.illuminance_lx, sizeof(double) * ROOM_SENSORS);
    assert_memory_equal(a.standard_error_lx, b.standard_error_lx, sizeof(double) * ROOM_SENSORS);
    assert_memory_equal(a.interval_95_lx, b.interval_95_lx, 2 * sizeof(double) * ROOM_SENSORS);
    orl_result_done(&a);
    orl_result_done(&b);
}

/* An unreachable error is reported soon, not after a million samples; a reachable one is named. */
static void test_out_of_reach(void **state)
{
    const struct scene_run run = job(ORL_TECHNIQUE_BACKWARD, 1e-6, 1);
    (void)state;
    struct orl_result r = scene_run(&run);
    assert_true(r.outcome.asked && !r.outcome.met);
    assert_non_null(strstr(r.outcome.why, "are allowed: ask for"));
    assert_true(r.outcome.rounds <= 3);
    orl_result_done(&r);
}

static void test_dark_sensors_do_not_block(void **state)
{
    static const struct orl_sensor sensors[2] = {{{2, 1, .8}, {0, 0, 1}}, {{2, 2, -1}, {0, 0, -1}}};
    struct scene_run run = job(ORL_TECHNIQUE_BACKWARD, 0.1, 1);
    (void)state;
    run.sensors = sensors;
    run.n_sensors = 2;
    struct orl_result r = scene_run(&run);
    assert_true(r.illuminance_lx[1] == 0);
    assert_true(r.outcome.met);
    orl_result_done(&r);
}

static struct orl_result run_until(double deadline_s, struct watch *watch)
{
    struct scene_run run = job(ORL_TECHNIQUE_BACKWARD, 0, 1);
    run.goal.deadline_s = deadline_s;
    run.now_s = tick;
    run.round_ready = count_round;
    run.ctx = watch;
    return scene_run(&run);
}

/* Uses a clock that advances by a constant at every call: a round takes equal time whatever its
 * size, which the run cannot know. It still ends within a round of the deadline. */
static void test_deadlines(void **state)
{
    struct watch clock = {.tick = 2}, short_clock = {.tick = 10};
    (void)state;
    struct orl_result r = run_until(60, &clock);
    assert_true(r.outcome.rounds >= 2);
    assert_true(fabs(r.total_s - 60) <= r.total_s / r.outcome.rounds);
    assert_true(r.outcome.achieved > 0);
    orl_result_done(&r);
    r = run_until(5, &short_clock);
    assert_false(r.outcome.met);
    assert_int_equal(r.outcome.rounds, 1);
    assert_non_null(strstr(r.outcome.why, "of the smallest size"));
    orl_result_done(&r);
}

/* Pixels of a view must meet it too, and pictures are written. */
static void test_views(void **state)
{
    struct scene_run run = job(ORL_TECHNIQUE_BACKWARD, 0.3, 1);
    (void)state;
    run.view = "-vtv -vp 2 4 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 45";
    run.width = 16;
    run.height = 12;
    struct orl_result r = scene_run(&run);
    assert_true(r.outcome.met);
    assert_int_equal(r.n_views, 1);
    assert_string_equal(r.views[0].files[ORL_PICTURE_HDR], "view.hdr");
    assert_true(r.cost.one_percent_s > 0 || isnan(r.cost.one_percent_s));
    orl_result_done(&r);
}

enum { WIDTH = 32, HEIGHT = 24 };

/* Returns the sum of a view's radiances by a final gather; with the watch's clock if there is a
 * deadline. */
static double sum_of_view(double deadline_s, double every_s, uint32_t *ret_rounds)
{
    struct watch watch = {.tick = every_s};
    struct scene_run run = job(ORL_TECHNIQUE_GATHER, 0, 1);
    double rgb[WIDTH * HEIGHT][3], sum = 0;
    char folder[64], path[96];
    cli_make_folder(folder);
    run.goal = (struct orl_goal){.deadline_s = deadline_s, .at = deadline_s > 0 ? 0.95 : 0};
    run.n_sensors = 0;
    run.view = "-vtv -vp 2 4 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 45";
    run.width = WIDTH;
    run.height = HEIGHT;
    run.folder = folder;
    run.global = 200000;
    run.now_s = every_s > 0 ? tick : NULL;
    run.ctx = &watch;
    struct orl_result r = scene_run(&run);
    *ret_rounds = r.outcome.rounds;
    snprintf(path, sizeof path, "%s/%s", folder, r.views[0].files[ORL_PICTURE_HDR]);
    hdr_read(path, WIDTH, HEIGHT, rgb);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        sum += rgb[i][0] + rgb[i][1] + rgb[i][2];
    orl_result_done(&r);
    cli_remove_folder(folder);
    return sum;
}

/*
 * Rounds of few rays and of many give one picture: with a clock that advances at every call it is
 * repeatable, and as bright as one in a single round.
 */
static void test_view_by_deadline(void **state)
{
    const double deadline_s = 100, every_s = 2;
    uint32_t rounds, again;
    (void)state;
    const double usual = sum_of_view(0, 0, &rounds);
    const double first = sum_of_view(deadline_s, every_s, &rounds);
    const double second = sum_of_view(deadline_s, every_s, &again);
    print_message("%u rounds: %.4f of the picture in one piece\n", rounds, first / usual);
    assert_true(rounds >= 2);
    assert_int_equal(rounds, again);
    assert_true(first == second);
    assert_true(fabs(first / usual - 1) < 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_accuracy_is_kept), cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_out_of_reach),     cmocka_unit_test(test_dark_sensors_do_not_block),
        cmocka_unit_test(test_deadlines),        cmocka_unit_test(test_views),
        cmocka_unit_test(test_view_by_deadline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
