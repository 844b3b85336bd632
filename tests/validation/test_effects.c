/*
 * Two rooms for each effect. In one the effect is insignificant: the plan skips it, the result
 * equals the forced one within the plan's bound, and the work is less (ratios are printed). In the
 * other, made to be easily missed, the effect is never skipped, and an override to skip it changes
 * the result.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/room.h"

/* A room of 4 x 5 x 3 m with walls of material w, without its south wall. */
#define FLOOR_AND_WALLS                                                                            \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
#define SHELL "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n" FLOOR_AND_WALLS
#define SKYLIGHT                                                                                   \
    "w polygon ceiling 0 0 30 0 0 3 0 5 3 4 5 3 4 0 3 0 0 3 1 3 3 2 3 3 2 4 3 1 4 3 1 3 3\n"       \
    "p polygon skylight 0 0 12 1 3 3 2 3 3 2 4 3 1 4 3\n"
#define LOW_SKY "void glow g 0 0 4 10 10 10 0\ng source sky 0 0 4 0 -1 -1 60\n"
#define SOUTH                                                                                      \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"
#define PANE "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
/* The window closed except a pane of 0.32 x 0.32 m: 0.1 m2. */
#define SMALL                                                                                      \
    "w polygon infill 0 0 30 1 0 1 1 0 2.5 3 0 2.5 3 0 1 1 0 1 "                                   \
    "2 0 1.5 2.32 0 1.5 2.32 0 1.82 2 0 1.82 2 0 1.5\n"                                            \
    "p polygon pane 0 0 12 2 0 1.5 2 0 1.82 2.32 0 1.82 2.32 0 1.5\n"
#define GREY "void plastic w 0 0 5 .5 .5 .5 0 0\n"
#define BLACK "void plastic w 0 0 5 0 0 0 0 0\n"
#define GLASS "void glass p 0 0 3 .9 .9 .9\n"
#define BSDF "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
#define SKY "void glow g 0 0 4 10 10 10 0\ng source sky 0 0 4 0 0 1 180\n"
#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
#define DIM_SUN "void light l 0 0 3 1e-6 1e-6 1e-6\nl source sun 0 0 4 0 -1 1 .533\n"
#define SUN_BEHIND "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 1 1 .533\n"
#define ROOM GREY GLASS SHELL SOUTH PANE

struct pair {
    enum orl_effect effect;
    const char *without, *with;
    bool by_view; /* true: a view needs the effect */
};

static const struct pair pairs[] = {
    /* First: a sun of a ten thousandth of a watt. Second: one that shines through only 0.1 m2. */
    {ORL_EFFECT_SUN, ROOM SKY DIM_SUN, GREY GLASS SHELL SOUTH SMALL SKY SUN, false},
    /* First: no sky. Second: one a thousand times dimmer than the sun's light. */
    {ORL_EFFECT_SKY, ROOM SUN,
     ROOM SUN "void glow g 0 0 4 .5 .5 .5 0\ng source sky 0 0 4 0 0 1 180\n", false},
    /* First: nothing outside. Second: a sunlit building opposite that the window does not see. */
    {ORL_EFFECT_EXTERIOR, ROOM SKY SUN,
     ROOM SKY SUN_BEHIND "void plastic o 0 0 5 .7 .7 .7 0 0\n"
                         "o polygon opposite 0 0 12 0 -20 0 0 -20 6 4 -20 6 4 -20 0\n",
     false},
    /* First: a mirror in a box without light. Second: two tiles of 4 cm that reflect the sun onto
       one spot. */
    {ORL_EFFECT_CAUSTICS_MIRROR,
     GREY BSDF SHELL SOUTH PANE SKY SUN_BEHIND
     "void mirror r 0 0 3 .9 .9 .9\n"
     "!genbox w box .4 .4 .4 | xform -t 1 3 1\n"
     "r polygon hidden 0 0 12 1.1 3.1 1.1 1.3 3.1 1.1 1.3 3.3 1.1 "
     "1.1 3.3 1.1\n",
     ROOM SKY SUN "void mirror r 0 0 3 .9 .9 .9\n"
                  "r polygon a 0 0 12 2 1.5 .05 2.04 1.5 .05 2.04 1.54 .052 2 1.54 .052\n"
                  "r polygon b 0 0 12 2.05 1.5 .05 2.09 1.5 .053 2.09 1.54 .055 2.05 1.54 .052\n",
     false},
    /* First: a BSDF pane with the sun behind it. Second: 0.1 m2 of one facing the sun. */
    {ORL_EFFECT_CAUSTICS_BSDF, GREY BSDF SHELL SOUTH PANE SKY SUN_BEHIND,
     GREY BSDF SHELL SOUTH SMALL SKY SUN, false},
    /* First: black walls. Second: black walls and a small white table top. */
    {ORL_EFFECT_INTERREFLECTION, BLACK SHELL SOUTH GLASS PANE SKY SUN,
     BLACK SHELL SOUTH GLASS PANE SKY SUN
     "void plastic t 0 0 5 .8 .8 .8 0 0\n"
     "t polygon top 0 0 12 2 1 .5 2.4 1 .5 2.4 1.4 .5 2 1.4 .5\n",
     false},
    /* First: a gloss of a thousand-millionth. Second: a polished table. */
    {ORL_EFFECT_GLOSSY, "void plastic w 0 0 5 .5 .5 .5 1e-9 .1\n" GLASS SHELL SOUTH PANE SKY SUN,
     ROOM SKY SUN "void plastic t 0 0 5 .3 .3 .3 .1 .05\n"
                  "t polygon top 0 0 12 1 1 .5 3 1 .5 3 2.5 .5 1 2.5 .5\n",
     false},
    /* First: all gray. Second: a red wall behind a white one. */
    {ORL_EFFECT_COLOR, ROOM SKY SUN,
     ROOM SKY SUN "void plastic r 0 0 5 .8 .05 .05 0 0\n"
                  "r polygon red 0 0 12 0.5 4.9 0 3.5 4.9 0 3.5 4.9 2 0.5 4.9 2\n"
                  "w polygon white 0 0 12 0.5 4.8 0 0.5 4.8 2 3.5 4.8 2 3.5 4.8 0\n",
     true},
    /* First: clear glass. Second: tinted glass of 2 cm. */
    {ORL_EFFECT_MEDIA,
     ROOM SKY SUN "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere ball 0 0 4 2 1.5 .1 .05\n",
     ROOM SKY SUN "void dielectric d 0 0 5 .01 .01 .01 1.5 0\nd sphere ball 0 0 4 2 1.5 .1 .02\n",
     false},
    /* First: nothing solid. Second: a marble in the sun. */
    {ORL_EFFECT_REFRACTION, ROOM SKY SUN,
     ROOM SKY SUN "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere ball 0 0 4 2 1.5 .1 .02\n", false},
    /* First: a lamp of almost no light. Second: a bright one behind a screen. */
    {ORL_EFFECT_LAMPS,
     ROOM SKY "void light b 0 0 3 1e-7 1e-7 1e-7\nb sphere bulb 0 0 4 2 4 2 .05\n",
     ROOM SKY "void light b 0 0 3 500 500 500\nb sphere bulb 0 0 4 2 4.9 .5 .02\n"
              "w polygon screen 0 0 12 1 4.8 0 3 4.8 0 3 4.8 2 1 4.8 2\n",
     false},
    /* First: a sun that no window faces. Second: a second sun that only a small pane faces. */
    {ORL_EFFECT_SUNS, ROOM SKY SUN_BEHIND,
     GREY GLASS SHELL SOUTH SMALL SKY SUN
     "void light k 0 0 3 1e5 1e5 1e5\nk source other 0 0 4 .8 -1 .8 .5\n",
     false},
    /* First: a skylight, with light from below only. Second: also a pane of 0.1 m2 in the south. */
    {ORL_EFFECT_PORTS,
     GREY GLASS FLOOR_AND_WALLS SKYLIGHT SOUTH
     "w polygon infill 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n" LOW_SKY,
     GREY GLASS FLOOR_AND_WALLS SKYLIGHT SOUTH SMALL LOW_SKY, false},
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

static const struct orl_sensor sensors[] = {
    {{2, 1.5, 0.001}, {0, 0, 1}}, {{1, 3, 0.001}, {0, 0, 1}}, {{2, 4, 1}, {0, -1, 0.3}}};
enum { SENSORS = sizeof sensors / sizeof *sensors, SEEDS = 3 };

static struct orl_result run_once(const struct pair *pair, const char *scene,
                                  enum orl_effect_override override, uint64_t seed)
{
    enum orl_effect_override overrides[ORL_EFFECT_COUNT] = {0};
    char bsdf[2048];
    const bool has_bsdf = strstr(scene, "pane.xml") != NULL;
    scene_uniform_bsdf(0.25, bsdf);
    overrides[pair->effect] = override;
    return scene_run(&(struct scene_run){.scene = scene,
                                         .resource_name = has_bsdf ? "pane.xml" : NULL,
                                         .resource_text = has_bsdf ? bsdf : NULL,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .view = pair->by_view ? "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 "
                                                                 "-vu 0 0 1 -vh 60 -vv 60"
                                                               : NULL,
                                         .width = 16,
                                         .height = 16,
                                         .overrides = overrides,
                                         .seed = seed,
                                         .global = extent(8000, 30000),
                                         .caustic = extent(2000, 3000),
                                         .samples = (uint32_t)extent(256, 512)});
}

/* Means of sensors over some seeds, the variance of the means, and the work. */
struct outcome {
    double mean[SENSORS], variance[SENSORS], seconds;
    uint64_t rays;
    struct orl_decision decision;
};

static struct outcome run_seeds(const struct pair *pair, const char *scene,
                                enum orl_effect_override override)
{
    struct outcome o = {.seconds = 0};
    double squares[SENSORS] = {0};
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = run_once(pair, scene, override, seed);
        for (int i = 0; i < SENSORS; i++) {
            o.mean[i] += r.illuminance_lx[i] / SEEDS;
            squares[i] += r.illuminance_lx[i] * r.illuminance_lx[i] / SEEDS;
        }
        o.seconds += r.total_s - r.timings_s[ORL_STAGE_LOAD] - r.timings_s[ORL_STAGE_BVH];
        o.rays += r.health.rays;
        o.decision = r.plan.effects[pair->effect];
        orl_result_done(&r);
    }
    for (int i = 0; i < SENSORS; i++)
        o.variance[i] = fmax(0, squares[i] - o.mean[i] * o.mean[i]) / (SEEDS - 1);
    return o;
}

static double bound_lx(const struct orl_decision *d, double lx)
{
    return d->unit == ORL_BOUND_LX ? d->bound : d->unit == ORL_BOUND_RELATIVE ? d->bound * lx : 0;
}

/* Expects the effect skipped, cheaper, and an equal result within the bound and the noise; the
 * noise estimate of three seeds is rough. */
static void check_without(const struct pair *pair)
{
    const char *name = orl_effect_name(pair->effect);
    const struct outcome planned = run_seeds(pair, pair->without, ORL_OVERRIDE_AUTO);
    const struct outcome forced = run_seeds(pair, pair->without, ORL_OVERRIDE_FORCE);
    print_message("  %-16s not called for: rays %.3f, time %.3f of forced; %s\n", name,
                  (double)planned.rays / (double)fmax((double)forced.rays, 1),
                  planned.seconds / forced.seconds, planned.decision.why);
    if (planned.decision.simulated)
        fail_msg("%s is simulated without need: %s", name, planned.decision.why);
    assert_true(forced.decision.simulated);
    for (int i = 0; i < SENSORS; i++) {
        const double off = fabs(planned.mean[i] - forced.mean[i]);
        const double noise = 6 * sqrt(planned.variance[i] + forced.variance[i]);
        const double bound = bound_lx(&planned.decision, forced.mean[i]);
        if (!(off <= bound + noise + 0.002 * forced.mean[i] + 1e-6))
            fail_msg("%s, sensor %d: %g planned, %g forced, bound %g, noise %g", name, i,
                     planned.mean[i], forced.mean[i], bound, noise);
    }
}

/* Expects that the effect is never skipped, and that the light lost by a skip override is within
 * its bound. */
static void check_with(const struct pair *pair)
{
    const char *name = orl_effect_name(pair->effect);
    const struct outcome planned = run_seeds(pair, pair->with, ORL_OVERRIDE_AUTO);
    const struct outcome skipped = run_seeds(pair, pair->with, ORL_OVERRIDE_SKIP);
    print_message("  %-16s called for: %s\n", name, planned.decision.why);
    if (!planned.decision.simulated)
        fail_msg("%s is missed: %s", name, planned.decision.why);
    assert_false(skipped.decision.simulated);
    for (int i = 0; i < SENSORS; i++) {
        const double off = fabs(planned.mean[i] - skipped.mean[i]);
        const double noise = 6 * sqrt(planned.variance[i] + skipped.variance[i]);
        const double bound = bound_lx(&skipped.decision, planned.mean[i]);
        if (!(off <= bound + noise + 0.002 * planned.mean[i] + 1e-6))
            fail_msg("%s, sensor %d: %g with, %g without, bound %g, noise %g", name, i,
                     planned.mean[i], skipped.mean[i], bound, noise);
    }
}

static void test_not_called_for(void **state)
{
    (void)state;
    for (int i = 0; i < PAIRS; i++)
        check_without(&pairs[i]);
}

static void test_easily_missed(void **state)
{
    (void)state;
    for (int i = 0; i < PAIRS; i++)
        check_with(&pairs[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_not_called_for),
                                       cmocka_unit_test(test_easily_missed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
