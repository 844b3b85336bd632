/*
 * Progress reports of a run, on a clock that advances a hundredth of a second at every call:
 * progress never decreases, goes from 0 to 1, and advances while photons are traced of which few
 * are stored.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>

#include "support/room.h"

#define GLOSS                                                                                      \
    "void plastic f 0 0 5 .3 .3 .3 .02 .1\nf polygon gloss 0 0 12 .2 .2 .01 3.8 .2 .01 "           \
    "3.8 4.8 .01 .2 4.8 .01\n"

static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE GLOSS;

struct log {
    double now, first, last;
    double told[ORL_STAGE_COUNT],
        rise[ORL_STAGE_COUNT]; /* per stage: the last fraction, and the largest increase */
    unsigned calls, falls, of[ORL_STAGE_COUNT];
};

static double now_s(void *ctx)
{
    struct log *log = ctx;
    return log->now += 0.01;
}

static void record_progress(void *ctx, enum orl_stage stage, double stage_fraction,
                            double job_fraction, double left_s)
{
    struct log *log = ctx;
    assert_true(left_s >= 0 && isfinite(left_s));
    log->first = log->calls == 0 ? job_fraction : log->first;
    log->falls += job_fraction < log->last;
    log->last = job_fraction;
    log->calls++;
    log->of[stage]++;
    log->rise[stage] = fmax(log->rise[stage], stage_fraction - log->told[stage]);
    log->told[stage] = stage_fraction;
}

static struct log run_logged(uint64_t caustic, struct orl_goal goal)
{
    struct log log = {.now = 0};
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = room_sensors,
                                                        .n_sensors = ROOM_SENSORS,
                                                        .samples = goal.at > 0 ? 0 : 64,
                                                        .caustic = caustic,
                                                        .goal = goal,
                                                        .now_s = now_s,
                                                        .progress = record_progress,
                                                        .ctx = &log});
    orl_result_done(&r);
    print_message("%u reports, %u of photons; from %.3f to %.3f, falls: %u\n", log.calls,
                  log.of[ORL_STAGE_PHOTONS], log.first, log.last, log.falls);
    assert_true(log.calls > 5 && log.falls == 0);
    assert_true(log.first < 0.1 && log.last == 1);
    return log;
}

/* 30 emissions per photon: rays measure progress, so no report covers half of them. Rounds of
 * batches are at most 32 of 8192 emissions, a quarter of the 1.2 million. */
static void test_photons_move(void **state)
{
    (void)state;
    const struct log log = run_logged(40000, (struct orl_goal){0});
    assert_true(log.of[ORL_STAGE_PHOTONS] > 8);
    assert_true(log.told[ORL_STAGE_PHOTONS] > 0.99 && log.rise[ORL_STAGE_PHOTONS] < 0.5);
}

/*
 * Every finished sensor and tile of a picture is reported, on one thread. A tile is a sixth of this
 * picture, a sensor at most an eighth of them; photon maps first render a coarse picture.
 */
static void test_rendering_moves(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_BACKWARD};
    struct orl_sensor sensors[8];
    (void)state;
    for (int i = 0; i < 8; i++)
        sensors[i] = room_sensors[i % ROOM_SENSORS];
    for (int i = 0; i < 4; i++) {
        struct log log = {.now = 0};
        struct scene_run run = {.scene = scene,
                                .samples = 64,
                                .technique = techniques[i / 2],
                                .pixel_samples = 4,
                                .now_s = now_s,
                                .progress = record_progress,
                                .ctx = &log};
        if (i % 2 == 0) {
            run.sensors = sensors;
            run.n_sensors = 8;
        } else {
            run.view = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 45";
            run.width = 96;
            run.height = 64;
        }
        struct orl_result r = scene_run(&run);
        orl_result_done(&r);
        print_message("%d: %u reports, %.3f at once\n", i, log.of[ORL_STAGE_RENDER],
                      log.rise[ORL_STAGE_RENDER]);
        assert_true(log.of[ORL_STAGE_RENDER] >= 6);
        assert_true(log.rise[ORL_STAGE_RENDER] < 0.3);
    }
}

/* Returns the share of progress that one of a picture's two tiles counts for. */
static double share_of_tile(const char *pane)
{
    char text[2000];
    struct log log = {.now = 0};
    snprintf(text, sizeof text, "%s%s%s", ROOM_SKY ROOM_GREY, pane, ROOM_SHELL ROOM_PANE);
    struct orl_result r =
        scene_run(&(struct scene_run){.scene = text,
                                      .technique = ORL_TECHNIQUE_GATHER,
                                      .view = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 "
                                              "-vv 30",
                                      .width = 64,
                                      .height = 32,
                                      .now_s = now_s,
                                      .progress = record_progress,
                                      .ctx = &log});
    orl_result_done(&r);
    return log.rise[ORL_STAGE_RENDER];
}

/* A scattering pane takes many rays per pixel, without a preparation phase. */
static void test_panes_take_time(void **state)
{
    const double clear = share_of_tile(ROOM_CLEAR);
    const double scatters = share_of_tile("void trans p 0 0 7 .9 .9 .9 0 .2 .9 .5\n");
    (void)state;
    print_message("%.3f of a picture through glass, %.3f through what scatters\n", clear, scatters);
    assert_true(scatters > 0.3 && scatters > 1.5 * clear);
}

static void test_a_goal_moves(void **state)
{
    (void)state;
    run_logged(0, (struct orl_goal){.relative_error = 0.3, .at = 0.95});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_photons_move), cmocka_unit_test(test_rendering_moves),
        cmocka_unit_test(test_panes_take_time), cmocka_unit_test(test_a_goal_moves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
