/*
 * Compares stated errors of DGP with actual ones: how often its 95 % interval holds the DGP of many
 * samples, over seeds. For N seeds a coverage p is measured with a standard deviation of sqrt(p (1
 * - p) / N); three of them are allowed.
 *
 * The short form uses one scene and 12 seeds, of which 10 must hold (at 95 % fewer do once in 51
 * times, and seeds are fixed). The long form uses 120 seeds of each of four scenes: each within 6
 * %, all 480 together within 3 %, then 92 to 98 %.
 *
 * The reference is one picture of 32 times a seed's samples. Its own noise, 1 / sqrt(32) of theirs,
 * lowers the coverage by 1.96 phi(1.96) / 32 = 0.4 % on average.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/references.h"
#include "support/room.h"
#include "support/stability.h"

#define LAMPS                                                                                      \
    "void light l 0 0 3 300 300 300\nl sphere a 0 0 4 1 3.5 2.6 .06\nl sphere b 0 0 4 3 3.5 2.6 "  \
    ".06\n"
#define SLATS "!genbox w slat 2 .12 .005 | xform -t 1 -.2 1.04 -a 12 -t 0 0 .12\n"
#define BRIGHT_SKY "void glow g 0 0 4 40 40 40 0\ng source sky 0 0 4 0 0 1 180\n"

static const struct glare_case {
    const char *name, *scene, *view;
} cases[] = {
    {"sun on the floor", ROOM_SUN BRIGHT_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
     "-vta -vp 2 3.2 1.2 -vd 0 -1 0 -vh 180 -vv 180"},
    {"bright sky behind slats", BRIGHT_SKY ROOM_GREY ROOM_SHELL SLATS,
     "-vta -vp 2 2.5 1.4 -vd .2 -1 0 -vh 180 -vv 180"},
    {"lamps", LAMPS ROOM_GREY ROOM_SHELL, "-vta -vp 2 1 1.2 -vd 0 1 .1 -vh 180 -vv 180"},
    {"wall beside the window", ROOM_SUN BRIGHT_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
     "-vth -vp 1.5 2 1.2 -vd -1 -.4 0 -vh 180 -vv 180"},
};
static const double coverage = 0.95;
enum { CASES = sizeof cases / sizeof cases[0], SAMPLES = 16, OF_REFERENCE = 32 * SAMPLES };

/* Pixels per side; the long form's pictures are finer. */
static uint32_t side(void)
{
    return stability_full() ? 40 : (uint32_t)extent(28, 40);
}

static struct orl_glare_value dgp_of(const struct glare_case *c, uint64_t seed, uint32_t samples)
{
    const struct scene_run run = {.scene = c->scene,
                                  .view = c->view,
                                  .width = side(),
                                  .height = side(),
                                  .metrics = 1U << ORL_GLARE_DGP,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .global = 4000,
                                  .pixel_samples = samples,
                                  .threads = stability_full() ? 2 : 1,
                                  .seed = seed};
    struct orl_result result = scene_run(&run);
    assert_non_null(result.views[0].glare);
    const struct orl_glare_value dgp = result.views[0].glare->values[ORL_GLARE_DGP];
    orl_result_done(&result);
    return dgp;
}

/* Returns the number of seeds whose intervals hold the reference. */
static uint32_t covered(const struct glare_case *c, uint32_t seeds, double *ret_reference,
                        double *ret_error)
{
    const double reference = dgp_of(c, 1000, OF_REFERENCE).value;
    uint32_t held = 0;
    *ret_error = 0;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        const struct orl_glare_value dgp = dgp_of(c, seed, SAMPLES);
        assert_true(dgp.standard_error > 0);
        held += dgp.interval_95[0] <= reference && reference <= dgp.interval_95[1];
        *ret_error += (dgp.interval_95[1] - dgp.interval_95[0]) / 2 / seeds;
    }
    *ret_reference = reference;
    return held;
}

/* Returns the tolerance of the share for that many seeds: relative, as for references. */
static double share_within(uint32_t seeds)
{
    return 3 * sqrt(coverage * (1 - coverage) / seeds) / coverage;
}

static void test_coverage(void **state)
{
    const bool full = stability_full();
    const uint32_t seeds = full ? 120 : 12;
    uint32_t all = 0;
    struct references set = {.name = "DGP's interval, share of seeds",
                             .tolerance = share_within(seeds)};
    (void)state;
    for (int i = 0; i < (full ? CASES : 1); i++) {
        double reference, error;
        const uint32_t held = covered(&cases[i], seeds, &reference, &error);
        char place[128];
        snprintf(place, sizeof place, "%s: DGP %.4f, +- %.4f", cases[i].name, reference, error);
        all += held;
        if (full)
            reference_row(&set, place, coverage, (double)held / seeds);
    }
    if (full) {
        reference_row_within(&set, "all four", coverage, (double)all / (CASES * seeds),
                             share_within(CASES * seeds));
        references_end(&set);
    }
    assert_true(full || all >= 10);
}

/* The stated interval meets a goal, and a finer goal takes more rounds. */
static void test_goals(void **state)
{
    uint32_t rounds[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct scene_run run = {.scene = cases[0].scene,
                                      .view = cases[0].view,
                                      .width = side(),
                                      .height = side(),
                                      .metrics = 1U << ORL_GLARE_DGP,
                                      .by_plan = true,
                                      .goal = {.dgp_error = i ? 0.001 : 0.02, .at = 0.95}};
        struct orl_result result = scene_run(&run);
        const double *interval = result.views[0].glare->values[ORL_GLARE_DGP].interval_95;
        assert_int_equal(result.plan.technique, ORL_TECHNIQUE_BACKWARD);
        assert_true(result.outcome.asked && result.outcome.met);
        assert_true((interval[1] - interval[0]) / 2 <= run.goal.dgp_error);
        assert_true(result.outcome.achieved == (interval[1] - interval[0]) / 2);
        rounds[i] = result.outcome.rounds;
        orl_result_done(&result);
    }
    assert_true(rounds[1] > rounds[0]);
}

/* One path per pixel gives no error estimate, but still a DGP. */
static void test_unknown_errors(void **state)
{
    (void)state;
    const struct scene_run run = {.scene = cases[0].scene,
                                  .view = cases[0].view,
                                  .width = side(),
                                  .height = side(),
                                  .metrics = 1U << ORL_GLARE_DGP,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .pixel_samples = 1};
    struct orl_result result = scene_run(&run);
    const struct orl_glare *glare = result.views[0].glare;
    assert_true(isnan(glare->values[ORL_GLARE_DGP].standard_error));
    assert_true(glare->values[ORL_GLARE_DGP].value > 0.16);
    assert_true(glare->class_of != ORL_GLARE_UNDECIDED);
    orl_result_done(&result);
}

/* The bytes are equal for any number of threads. */
static void test_any_pool_size(void **state)
{
    struct orl_glare_value found[2];
    (void)state;
    for (uint32_t i = 0; i < 2; i++) {
        const struct scene_run run = {.scene = cases[1].scene,
                                      .view = cases[1].view,
                                      .width = side(),
                                      .height = side(),
                                      .metrics = 1U << ORL_GLARE_DGP,
                                      .technique = ORL_TECHNIQUE_BACKWARD,
                                      .pixel_samples = 4,
                                      .threads = 1 + 2 * i};
        struct orl_result result = scene_run(&run);
        found[i] = result.views[0].glare->values[ORL_GLARE_DGP];
        orl_result_done(&result);
    }
    assert_true(found[0].value == found[1].value);
    assert_true(found[0].interval_95[0] == found[1].interval_95[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coverage), cmocka_unit_test(test_goals),
        cmocka_unit_test(test_unknown_errors), cmocka_unit_test(test_any_pool_size)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
