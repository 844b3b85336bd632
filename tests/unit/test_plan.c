/*
 * Plans for lights and windows: a scene that does not need an effect, and one that does but is
 * easily missed; effect overrides; and equal plans for any number of threads. Every reason contains
 * a number.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/plan_query.h"

/* ---- Lights ---------------------------------------------------------------------------------- */

static void test_sun(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY ROOM, ORL_EFFECT_SUN, 0);
    /* Half a degree in front of the pane's plane, and weak. */
    plan_expect_simulated(SKY ROOM
                          "void light l 0 0 3 10 10 10\nl source sun 0 0 4 1 -.005 1 .533\n",
                          ORL_EFFECT_SUN);
    plan_text(SKY NORTH_SUN ROOM, &left);
    assert_int_equal(left.suns, 0);
}

/* With the sun behind the house and nothing outside, no sun comes in; a house opposite reflects it
 * in. */
static void test_suns(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_SUNS, 0);
    plan_expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_SUN, 0);
    plan_expect_simulated(SKY NORTH_SUN ROOM OPPOSITE, ORL_EFFECT_SUNS);
    plan_expect_simulated(SKY NORTH_SUN ROOM OPPOSITE, ORL_EFFECT_SUN);
    plan_text(SKY SUN SECOND_NORTH_SUN ROOM, &left);
    assert_int_equal(left.suns, 1);
    plan_text(SKY SUN SECOND_NORTH_SUN ROOM OPPOSITE, &left);
    assert_int_equal(left.suns, 2);
}

/* It still shines on the roof, and through a hole of 10 x 10 cm in the north. */
static void test_suns_that_are_seen(void **state)
{
    static const struct orl_sensor roof = {{2, 2.5, 3.2}, {0, 0, 1}};
    struct plan_left left;
    (void)state;
    plan_of(&(struct plan_query){.text = SKY NORTH_SUN ROOM, .sensor = &roof}, &left);
    assert_int_equal(left.suns, 1);
    plan_text(SKY NORTH_SUN ROOM_GREY ROOM_CLEAR ROOM_PANE
              "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
              "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
              "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
              "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
              "w polygon north 0 0 30 0 5 0 4 5 0 4 5 3 0 5 3 0 5 0 "
              "2 5 1 2 5 1.1 2.1 5 1.1 2.1 5 1 2 5 1\n"
              "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "
              "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n",
              &left);
    assert_int_equal(left.suns, 1);
}

static void test_sky(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SUN ROOM, ORL_EFFECT_SKY, 0);
    /* A ten-millionth of a watt beside the sun is 6e-5 lx, and skipped; alone, it is all the
     * light. */
    plan_expect_skipped(
        "void glow g 0 0 4 1e-7 1e-7 1e-7 0\ng source sky 0 0 4 0 0 1 180\n" SUN ROOM,
        ORL_EFFECT_SKY, 0.01);
    plan_expect_simulated("void glow g 0 0 4 1e-7 1e-7 1e-7 0\ng source sky 0 0 4 0 0 1 180\n" ROOM,
                          ORL_EFFECT_SKY);
    plan_text(SUN ROOM, &left);
    assert_int_equal(left.domes, 0);
}

static void test_lamps(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY ROOM, ORL_EFFECT_LAMPS, 0);
    plan_expect_skipped(SKY SUN ROOM
                        "void light dim 0 0 3 1e-6 1e-6 1e-6\ndim sphere s 0 0 4 2 2 2 .1\n",
                        ORL_EFFECT_LAMPS, 0.01);
    plan_expect_simulated(SKY SUN ROOM
                          "void light led 0 0 3 50 50 50\nled sphere s 0 0 4 2 2 2 .001\n",
                          ORL_EFFECT_LAMPS);
    plan_text(SKY SUN ROOM "void light dim 0 0 3 1e-6 1e-6 1e-6\ndim sphere s 0 0 4 2 2 2 .1\n",
              &left);
    assert_int_equal(left.emitters, 0);
}

/* ---- Windows --------------------------------------------------------------------------------- */

static void test_exterior(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_EXTERIOR, 0);
    plan_expect_simulated(SKY SUN ROOM OPPOSITE, ORL_EFFECT_EXTERIOR);
    /* A sill that extends outwards by 5 cm. */
    plan_expect_simulated(SKY SUN ROOM "w polygon sill 0 0 12 1 -.05 1 3 -.05 1 3 0 1 1 0 1\n",
                          ORL_EFFECT_EXTERIOR);
    /* A black sill shades and reflects nothing. */
    plan_expect_skipped(SKY SUN ROOM "void plastic k 0 0 5 0 0 0 0 0\n"
                                     "k polygon sill 0 0 12 1 -.05 1 3 -.05 1 3 0 1 1 0 1\n",
                        ORL_EFFECT_EXTERIOR, 0);
    /* But the panes reflect, and a sensor in front of them sees it. */
    static const struct orl_sensor before = {{2, -.5, 1.5}, {0, 1, 0}};
    const struct orl_plan seen = plan_of(
        &(struct plan_query){.text = SKY SUN ROOM "void plastic k 0 0 5 0 0 0 0 0\n"
                                                  "k polygon sill 0 0 12 1 -.05 1 3 -.05 1 3 0 "
                                                  "1 1 0 1\n",
                             .sensor = &before},
        NULL);
    assert_true(seen.effects[ORL_EFFECT_EXTERIOR].simulated);
    plan_text(SKY SUN ROOM, &left);
    assert_true(left.clear && !left.omit.exterior);
    plan_text(SKY SUN ROOM OPPOSITE, &left);
    assert_false(left.clear);
}

/* The only light is around the northern horizon, or extends a little to the south. */
static void test_ports(void **state)
{
    struct plan_left left;
    (void)state;
    plan_expect_skipped("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM,
                        ORL_EFFECT_PORTS, 0);
    plan_text("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM, &left);
    assert_true(left.silent);
    plan_expect_simulated("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 182\n" ROOM,
                          ORL_EFFECT_PORTS);
    plan_expect_simulated("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM OPPOSITE,
                          ORL_EFFECT_PORTS);
}

/* ---- Overrides and requests ------------------------------------------------------------------ */

/* The text uses the singular for one item. */
static void test_singular(void **state)
{
    (void)state;
    const struct orl_plan plan =
        plan_of(&(struct plan_query){.text = SKY SUN ROOM, .view = true}, NULL);
    assert_non_null(strstr(plan.technique_why, "1 view:"));
    assert_non_null(strstr(plan.effects[ORL_EFFECT_FINAL_GATHER].why, "0 sensors and 1 view"));
    assert_non_null(strstr(plan.effects[ORL_EFFECT_PORTS].why, "1 of 1 window faces"));
    assert_non_null(strstr(plan.effects[ORL_EFFECT_SUNS].why, "1 of 1 sun is in front"));
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        assert_null(strstr(plan.effects[i].why, "1 windows"));
}

static void test_techniques(void **state)
{
    struct orl_plan plan = plan_text(SKY SUN ROOM, NULL);
    (void)state;
    assert_int_equal(plan.technique, ORL_TECHNIQUE_BACKWARD);
    assert_false(plan.effects[ORL_EFFECT_FINAL_GATHER].simulated);
    assert_false(plan.effects[ORL_EFFECT_GLARE].simulated);
    assert_false(plan.effects[ORL_EFFECT_BINS].simulated);
    assert_true(plan_holds_number(plan.technique_why));
    plan = plan_of(&(struct plan_query){.text = SKY SUN ROOM, .view = true}, NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_GATHER);
    assert_true(plan.effects[ORL_EFFECT_FINAL_GATHER].simulated);
    plan = plan_of(&(struct plan_query){.text = SKY SUN ROOM,
                                        .view = true,
                                        .effect = ORL_EFFECT_FINAL_GATHER,
                                        .override = ORL_OVERRIDE_SKIP},
                   NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_DIRECT);
    assert_false(plan.effects[ORL_EFFECT_FINAL_GATHER].simulated);
    plan = plan_of(&(struct plan_query){.text = SKY SUN ROOM,
                                        .effect = ORL_EFFECT_FINAL_GATHER,
                                        .override = ORL_OVERRIDE_FORCE},
                   NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_GATHER);
    plan = plan_of(
        &(struct plan_query){.text = SKY SUN ROOM DISH, .technique = ORL_TECHNIQUE_PRECOMPUTED},
        NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_PRECOMPUTED);
    assert_int_equal(plan.photons_global, ORL_DEFAULT_PHOTONS);
    plan = plan_of(&(struct plan_query){.text = SKY SUN ROOM DISH, .caustic = 1234}, NULL);
    assert_int_equal(plan.photons_caustic, 1234);
}

/* A room with all effects. */
static const char all_of_it[] = SKY SUN SECOND_NORTH_SUN ROOM OPPOSITE DISH
    "void dielectric d 0 0 5 .9 .8 .9 1.5 0\nd sphere bead 0 0 4 2 1.5 .5 .003\n"
    "void light led 0 0 3 50 50 40\nled sphere s 0 0 4 2 2 2 .01\n"
    "void plastic gloss 0 0 5 .5 .4 .5 .02 .1\ngloss ring spot 0 0 8 2 4 .001 0 0 1 0 .01\n";

static void test_wishes(void **state)
{
    (void)state;
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        const enum orl_effect effect = (enum orl_effect)i;
        const bool fixed = effect == ORL_EFFECT_GLARE || effect == ORL_EFFECT_BINS;
        const struct orl_plan forced = plan_of(&(struct plan_query){.text = SKY ROOM,
                                                                    .effect = effect,
                                                                    .override = ORL_OVERRIDE_FORCE},
                                               NULL);
        const struct orl_plan skipped = plan_of(&(struct plan_query){.text = all_of_it,
                                                                     .effect = effect,
                                                                     .override = ORL_OVERRIDE_SKIP},
                                                NULL);
        const struct orl_plan planned = plan_text(all_of_it, NULL);
        assert_int_equal(forced.effects[i].override, ORL_OVERRIDE_FORCE);
        assert_int_equal(skipped.effects[i].override, ORL_OVERRIDE_SKIP);
        assert_int_equal(forced.effects[i].simulated, !fixed);
        /* Light straight through panes uses shadow rays: it cannot be left out. */
        assert_int_equal(skipped.effects[i].simulated, effect == ORL_EFFECT_CAUSTICS_GLASS);
        assert_int_equal(planned.effects[i].simulated, !fixed);
        if (planned.effects[i].unit != ORL_BOUND_NONE && effect != ORL_EFFECT_CAUSTICS_GLASS)
            assert_true(skipped.effects[i].bound > 0);
    }
}

static void test_skips_are_done(void **state)
{
    struct plan_left left;
    (void)state;
    plan_of(&(struct plan_query){.text = all_of_it,
                                 .effect = ORL_EFFECT_SUN,
                                 .override = ORL_OVERRIDE_SKIP},
            &left);
    assert_int_equal(left.suns, 0);
    plan_of(&(struct plan_query){.text = all_of_it,
                                 .effect = ORL_EFFECT_SKY,
                                 .override = ORL_OVERRIDE_SKIP},
            &left);
    assert_int_equal(left.domes, 0);
    plan_of(&(struct plan_query){.text = all_of_it,
                                 .effect = ORL_EFFECT_LAMPS,
                                 .override = ORL_OVERRIDE_SKIP},
            &left);
    assert_int_equal(left.emitters, 0);
    plan_of(&(struct plan_query){.text = all_of_it,
                                 .effect = ORL_EFFECT_EXTERIOR,
                                 .override = ORL_OVERRIDE_SKIP},
            &left);
    assert_true(left.omit.exterior);
    plan_of(&(struct plan_query){.text = all_of_it,
                                 .effect = ORL_EFFECT_PORTS,
                                 .override = ORL_OVERRIDE_SKIP},
            &left);
    assert_true(left.silent);
    plan_of(&(struct plan_query){.text = SKY ROOM,
                                 .effect = ORL_EFFECT_EXTERIOR,
                                 .override = ORL_OVERRIDE_FORCE},
            &left);
    assert_false(left.clear);
}

/* The plan is equal for any number of threads, except for the seconds. */
static void test_threads(void **state)
{
    struct orl_plan one = plan_of(&(struct plan_query){.text = all_of_it, .threads = 1}, NULL);
    struct orl_plan three = plan_of(&(struct plan_query){.text = all_of_it, .threads = 3}, NULL);
    (void)state;
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        assert_int_equal(one.effects[i].simulated, three.effects[i].simulated);
        assert_true(one.effects[i].bound == three.effects[i].bound);
        assert_string_equal(one.effects[i].why, three.effects[i].why);
    }
    assert_int_equal(one.technique, three.technique);
    assert_string_equal(one.technique_why, three.technique_why);
    assert_true(one.photons_global == three.photons_global &&
                one.photons_caustic == three.photons_caustic);
}

/* The plan of a diffuse room without sun or colour has neither. */
static void test_plain_room(void **state)
{
    struct plan_left left;
    const struct orl_plan plan =
        plan_of(&(struct plan_query){.text = SKY ROOM, .view = true}, &left);
    (void)state;
    assert_false(plan.effects[ORL_EFFECT_SUN].simulated);
    assert_false(plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].simulated);
    assert_false(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].simulated);
    assert_int_equal(plan.channels, 1);
    assert_int_equal(plan.photons_caustic, 0);
    /* Smooth light: a final gather needs few photons. */
    assert_in_range(plan.photons_global, 50000, 500000);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        assert_true(plan.effects[i].simulated || plan.effects[i].bound == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sun),
        cmocka_unit_test(test_suns),
        cmocka_unit_test(test_suns_that_are_seen),
        cmocka_unit_test(test_sky),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_exterior),
        cmocka_unit_test(test_ports),
        cmocka_unit_test(test_singular),
        cmocka_unit_test(test_techniques),
        cmocka_unit_test(test_wishes),
        cmocka_unit_test(test_skips_are_done),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_plain_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
