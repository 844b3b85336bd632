/*
 * What a run tells of its progress, on a clock that goes on by a hundredth of a second whenever it
 * is looked at: it never falls, goes from nothing to all, and moves while photons fly of which few
 * come to anything.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "support/room.h"

#define GLOSS                                                                                      \
    "void plastic f 0 0 5 .3 .3 .3 .02 .1\nf polygon gloss 0 0 12 .2 .2 .01 3.8 .2 .01 "           \
    "3.8 4.8 .01 .2 4.8 .01\n"

static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE GLOSS;

struct log {
    double now, first, last, photons, rise;
    unsigned calls, falls, of_photons;
};

static double now_s(void *ctx)
{
    struct log *log = ctx;
    return log->now += 0.01;
}

static void take(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction)
{
    struct log *log = ctx;
    log->first = log->calls == 0 ? job_fraction : log->first;
    log->falls += job_fraction < log->last;
    log->last = job_fraction;
    log->calls++;
    if (stage != ORL_STAGE_PHOTONS)
        return;
    log->of_photons++;
    log->rise = fmax(log->rise, stage_fraction - log->photons);
    log->photons = stage_fraction;
}

static struct log follow(uint64_t caustic, struct orl_goal goal)
{
    struct log log = {.now = 0};
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = room_sensors,
                                                        .n_sensors = ROOM_SENSORS,
                                                        .samples = goal.at > 0 ? 0 : 64,
                                                        .caustic = caustic,
                                                        .goal = goal,
                                                        .now_s = now_s,
                                                        .progress = take,
                                                        .ctx = &log});
    orl_result_done(&r);
    print_message("%u reports, %u of photons; from %.3f to %.3f, falls: %u\n", log.calls,
                  log.of_photons, log.first, log.last, log.falls);
    assert_true(log.calls > 5 && log.falls == 0);
    assert_true(log.first < 0.1 && log.last == 1);
    return log;
}

/* 30 emissions a photon: rays tell how far they are, so no report stands for half of them. Rounds
 * of batches are at most 32 of 8192 emissions, a quarter of the 1.2 million. */
static void test_photons_move(void **state)
{
    (void)state;
    const struct log log = follow(40000, (struct orl_goal){0});
    assert_true(log.of_photons > 8);
    assert_true(log.photons > 0.99 && log.rise < 0.5);
}

static void test_a_goal_moves(void **state)
{
    (void)state;
    follow(0, (struct orl_goal){.relative_error = 0.3, .at = 0.95});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_photons_move),
                                       cmocka_unit_test(test_a_goal_moves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
