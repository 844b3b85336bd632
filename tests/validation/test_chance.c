/*
 * Light that the backward technique finds only by chance: suns by way of curved or very many
 * mirrors. If the job names backward, it misses that light and warns with an estimate of the
 * amount, but not if the amount is insignificant or was found. If the plan selects the technique,
 * it uses photons.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/scene_text.h"

#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 0 .533\n"
#define SKY "void glow g 0 0 4 20 20 20 0\ng source sky 0 0 4 0 0 1 180\n"
#define GLARE "void mirror m 0 0 3 .9 .9 .9\n"

/* The sensor faces away from the sun, toward the mirrors. */
static const struct orl_sensor sensor = {{0, -3, 0}, {0, 1, 0}};

static const char *warning_of(const struct orl_result *result)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], "lack light"))
            return result->warnings[i];
    return NULL;
}

static double sun_lx(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return ORL_EFFICACY_LM_PER_W * 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

static struct orl_result run_scene(const char *scene, enum orl_technique technique)
{
    return scene_run(&(struct scene_run){.scene = scene,
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .technique = technique,
                                         .by_plan = technique == ORL_TECHNIQUE_AUTO,
                                         .caustic = 30000,
                                         .samples = 512});
}

/* Returns the missing illuminance in a warning. */
static double said_lx(const char *warning)
{
    double lx = 0;
    const char *at = strstr(warning, "lacks about ");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "lacks about %lf lx", &lx), 1);
    return lx;
}

/*
 * Expects that backward misses this light, within a quarter of its estimate (photons know it to a
 * tenth, and no more is promised); that its interval is widened to hold it; and that the plan's
 * technique finds it.
 */
static void check_missed(const char *scene, double missed)
{
    struct orl_result backward = run_scene(scene, ORL_TECHNIQUE_BACKWARD),
                      planned = run_scene(scene, ORL_TECHNIQUE_AUTO);
    const char *warning = warning_of(&backward);
    if (!warning || !(fabs(said_lx(warning) - missed) < 0.25 * missed))
        fail_msg("missed %g lx, but: %s", missed, warning ? warning : "nothing is said");
    assert_true(3 * backward.standard_error_lx[0] < 0.5 * missed);
    assert_true(backward.interval_95_lx[0][1] >= backward.illuminance_lx[0] + missed);
    assert_true(backward.doubts && backward.doubts[0] & ORL_DOUBT_MISSED_LIGHT);
    assert_int_equal(planned.plan.technique, ORL_TECHNIQUE_GATHER);
    assert_null(warning_of(&planned));
    assert_null(planned.doubts);
    const double found = planned.illuminance_lx[0] - backward.illuminance_lx[0];
    const double error = hypot(planned.standard_error_lx[0], backward.standard_error_lx[0]) +
                         fabs(planned.bias_estimate_lx[0]);
    if (!(fabs(found - missed) < 4 * error + 0.02 * missed))
        fail_msg("%g +- %g lx are found, not %g", found, error, missed);
    orl_result_done(&backward);
    orl_result_done(&planned);
}

/* A goal is not reported as met if only the stated errors of paths meet it. */
static void check_not_met(const char *scene)
{
    struct orl_result r =
        scene_run(&(struct scene_run){.scene = scene,
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .technique = ORL_TECHNIQUE_BACKWARD,
                                      .goal = {.relative_error = 0.02, .at = 0.95}});
    assert_true(r.outcome.asked && r.outcome.achieved < 0.02);
    assert_false(r.outcome.met);
    assert_string_equal(r.outcome.why, "1 sensor is unreliable: see warnings");
    orl_result_done(&r);
}

/*
 * A ball of radius r spreads the sun's light: straight back, at a distance s, by (r / (r + 2 s))^2.
 */
static void a_mirror_ball(void **state)
{
    (void)state;
    check_missed(SUN SKY GLARE "m sphere ball 0 0 4 0 0 0 2\n", 0.9 * sun_lx() / 4);
    check_not_met(SUN SKY GLARE "m sphere ball 0 0 4 0 0 0 2\n");
}

/*
 * Flat strips on an arc around the sensor, each turned to reflect the sun to it. They have more
 * orientations than there are virtual suns, which the widest strips get.
 */
static void a_trough_of_strips(void **state)
{
    enum { STRIPS = 49 };
    static char scene[16384];
    int at = snprintf(scene, sizeof scene, "%s", SUN SKY GLARE);
    double missed = 0;
    (void)state;
    for (int i = 0; i < STRIPS; i++) {
        const bool narrow = i >= ORL_MOST_MIRRORS;
        const double angle = (i - STRIPS / 2) * 0.04, x = 5 * sin(angle), y = -3 + 5 * cos(angle);
        const double half = narrow ? 0.04 : 0.05, c = half * cos(0.5 * angle),
                     s = half * sin(0.5 * angle);
        at += snprintf(scene + at, sizeof scene - (size_t)at,
                       "m polygon p%d 0 0 12 %.9g %.9g -.1 %.9g %.9g -.1 %.9g %.9g .1 %.9g %.9g "
                       ".1\n",
                       i, x - c, y + s, x + c, y - s, x + c, y - s, x - c, y + s);
        missed += narrow ? 0.9 * sun_lx() * cos(angle) : 0;
    }
    check_missed(scene, missed);
}

/* A ball spreads the sun's light, and two facing mirrors that of a lamp: either may be what lacks.
 */
static void a_warning_names_all_classes(void **state)
{
    (void)state;
    struct orl_result r = run_scene(
        SUN SKY GLARE "m sphere ball 0 0 4 0 0 0 2\n"
                      "m polygon a 0 0 12 3 -4 -1 3 -2 -1 3 -2 1 3 -4 1\n"
                      "m polygon b 0 0 12 5 -4 -1 5 -4 1 5 -2 1 5 -2 -1\n"
                      "void light bulb 0 0 3 1e5 1e5 1e5\nbulb sphere s 0 0 4 4 -3 0 .05\n",
        ORL_TECHNIQUE_BACKWARD);
    const char *warning = warning_of(&r);
    assert_non_null(warning);
    if (!strstr(warning, "by way of curved mirrors") ||
        !strstr(warning, ", or lamps by way of two"))
        fail_msg("%s", warning);
    orl_result_done(&r);
}

/* ---- No warning ------------------------------------------------------------------------------ */

static void check_quiet(const char *scene, uint32_t samples)
{
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = &sensor,
                                                        .n_sensors = 1,
                                                        .technique = ORL_TECHNIQUE_BACKWARD,
                                                        .samples = samples});
    if (warning_of(&r))
        fail_msg("%s", warning_of(&r));
    orl_result_done(&r);
}

/* A chromed rod of 4 mm, 3 m away, reflects a thousandth of the sky's light. */
static void a_thin_rod(void **state)
{
    (void)state;
    check_quiet(SUN SKY GLARE "m cylinder rod 0 0 7 0 0 -1 0 0 1 .002\n", 1024);
}

/* A wide lamp is no sun: the one behind the sensor, seen in a ball, is hit by one path of 25. */
static void a_wide_lamp(void **state)
{
    (void)state;
    check_quiet(SKY GLARE "m sphere ball 0 0 4 0 0 0 2\nvoid light w 0 0 3 1000 1000 1000\n"
                          "w sphere lamp 0 0 4 0 -4.1 0 1.05\n",
                4096);
}

/* ---- Views ----------------------------------------------------------------------------------- */

#define FLOOR                                                                                      \
    "void plastic p 0 0 5 .5 .5 .5 0 0\np polygon f 0 0 12 -9 -9 -2 9 -9 -2 9 9 -2 -9 9 -2\n"

static bool is_said_of_view(const char *scene)
{
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .view = "-vp 0 -8 3 -vd 0 1 -.4",
                                                        .width = 8,
                                                        .height = 8,
                                                        .pixel_samples = 1,
                                                        .technique = ORL_TECHNIQUE_BACKWARD});
    const bool said = warning_of(&r) && strstr(warning_of(&r), "views lack light");
    orl_result_done(&r);
    return said;
}

static void views(void **state)
{
    (void)state;
    assert_true(is_said_of_view(SUN SKY FLOOR GLARE "m sphere ball 0 0 4 0 0 0 2\n"));
    assert_false(is_said_of_view(SUN SKY FLOOR GLARE "m cylinder r 0 0 7 0 0 -2 0 0 1 .002\n"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mirror_ball),
        cmocka_unit_test(a_trough_of_strips),
        cmocka_unit_test(a_thin_rod),
        cmocka_unit_test(a_wide_lamp),
        cmocka_unit_test(a_warning_names_all_classes),
        cmocka_unit_test(views),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
