/* Plans for caustics and for surfaces, as test_plan.c for lights and windows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/plan_query.h"

/* ---- Caustics -------------------------------------------------------------------------------- */

static void test_mirrors(void **state)
{
    struct plan_left left;
    struct orl_plan plan;
    (void)state;
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    plan_expect_skipped(SKY ROOM DISH, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    plan_expect_skipped(SKY SUN ROOM DISH_IN_SHADE, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    plan_expect_simulated(SKY SUN ROOM DISH, ORL_EFFECT_CAUSTICS_MIRROR);
    plan = plan_text(SKY SUN ROOM DISH, &left);
    assert_true(left.caustics_lit && !left.omit.mirror_caustics && left.omit.lobe_caustics);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_GATHER); /* paths would find it by chance */
    assert_true(plan.photons_caustic > 0);
    plan = plan_text(SKY SUN ROOM, &left);
    assert_true(!left.caustics_lit && left.omit.mirror_caustics && left.omit.lobe_caustics);
    assert_int_equal(plan.photons_caustic, 0);
    assert_true(
        plan_text(SKY SUN ROOM DISH_IN_SHADE, NULL).effects[ORL_EFFECT_CAUSTICS_MIRROR].saved_s >
        0);
    assert_true(plan_text(SKY ROOM DISH, NULL).effects[ORL_EFFECT_CAUSTICS_MIRROR].saved_s == 0);
    /* A lamp lights it, in the shade of the sun or without one. */
    plan_expect_simulated(SKY SUN ROOM DISH_IN_SHADE
                          "void light led 0 0 3 50 50 50\nled sphere s 0 0 4 2 2 2 .01\n",
                          ORL_EFFECT_CAUSTICS_MIRROR);
}

/*
 * A mirror in the sun's patch, by an open window. A sensor that faces the sun's image receives the
 * mirror's reflectance times the sun's irradiance, pi sin^2 a L for half angle a. A curved mirror
 * may focus the sun, and so add more.
 */
static void test_what_mirrors_may_add(void **state)
{
    static const char *const scenes[2] = {
        SKY SUN ROOM_GREY ROOM_SHELL "void mirror m 0 0 3 .9 .9 .9\n"
                                     "m polygon flat 0 0 12 1.5 1.2 .01 2.5 1.2 .01 2.5 2.2 .01 "
                                     "1.5 2.2 .01\n",
        SKY SUN ROOM_GREY ROOM_SHELL DISH};
    const double sine = sin(0.533 / 2 * ORL_DEG_TO_RAD);
    const double added_lx = 0.9 * ORL_EFFICACY_LM_PER_W * ORL_PI * sine * sine * 1e6;
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct orl_plan plan = plan_text(scenes[i], NULL);
        const struct orl_decision *d = &plan.effects[ORL_EFFECT_CAUSTICS_MIRROR];
        if (!d->simulated || !(d->bound >= 0.999 * added_lx))
            fail_msg("%s: the bound is %g lx, a mirror adds %g lx", d->why, d->bound, added_lx);
    }
}

/* A small pane of a house opposite reflects the northern sun into the window. */
static void test_mirrors_outside(void **state)
{
    (void)state;
    plan_expect_simulated(SKY NORTH_SUN ROOM
                          "void mirror m 0 0 3 .9 .9 .9\n"
                          "m polygon q 0 0 12 2.2 -9 10.5 1.8 -9 10.5 1.8 -9 10.9 "
                          "2.2 -9 10.9\n",
                          ORL_EFFECT_CAUSTICS_MIRROR);
    /* Lower down it reflects the sun at the wall below: shadow rays sample that, without photons.
     */
    struct plan_left left;
    const struct orl_plan plan = plan_of(
        &(struct plan_query){.text = SKY NORTH_SUN ROOM
                             "void mirror m 0 0 3 .9 .9 .9\n"
                             "m polygon q 0 0 12 2.2 -9 8.5 1.8 -9 8.5 1.8 -9 8.9 2.2 -9 8.9\n",
                             .technique = ORL_TECHNIQUE_GATHER},
        &left);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].simulated);
    assert_false(left.caustics_lit);
    assert_int_equal(plan.photons_caustic, 0);
    /* With nothing outside for light to be reflected at, there is nothing to simulate. */
    plan_expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_CAUSTICS_MIRROR, 0);
}

static void test_lobes(void **state)
{
    static char bsdf[2048];
    static const char small[] = SKY SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_BSDF
        "void glass q 0 0 3 .9 .9 .9\n"
        "q polygon pane 0 0 12 1 0 1 2.9 0 1 2.9 0 2.5 1 0 2.5\n"
        "q polygon pane2 0 0 12 2.9 0 1 3 0 1 3 0 1.5 2.9 0 1.5\n"
        "p polygon small 0 0 12 2.9 0 1.5 3 0 1.5 3 0 2.5 2.9 0 2.5\n";
    struct orl_plan plan;
    (void)state;
    scene_uniform_bsdf(0.1, bsdf);
    plan = plan_of(&(struct plan_query){.text = small, .bsdf = bsdf}, NULL);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].simulated);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].bound > 0);
    /* The window with the sun behind the house. */
    plan =
        plan_of(&(struct plan_query){.text = SKY NORTH_SUN ROOM_GREY ROOM_SHELL ROOM_BSDF ROOM_PANE,
                                     .bsdf = bsdf},
                NULL);
    assert_false(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].simulated);
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_CAUSTICS_BSDF, 0);
    /* Rough steel, the size of a coin, in the sun's patch. */
    plan_expect_simulated(SKY SUN ROOM "void metal s 0 0 5 .6 .6 .6 .9 .1\n"
                                       "s ring coin 0 0 8 2 1.5 .001 0 0 1 0 .01\n",
                          ORL_EFFECT_CAUSTICS_BSDF);
}

/* If a technique cannot leave out an effect, the plan does not claim that it does. */
static void test_caustics_of_paths(void **state)
{
    const struct orl_plan plan = plan_of(&(struct plan_query){.text = SKY SUN ROOM DISH,
                                                              .technique = ORL_TECHNIQUE_BACKWARD,
                                                              .effect = ORL_EFFECT_CAUSTICS_MIRROR,
                                                              .override = ORL_OVERRIDE_SKIP},
                                         NULL);
    (void)state;
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].simulated);
    assert_non_null(strstr(plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].why, "anyway"));
}

static void test_glass(void **state)
{
    struct orl_plan plan;
    (void)state;
    plan = plan_text(SKY SUN ROOM, NULL);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_GLASS].simulated);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_GLASS].bound == 0);
    plan_expect_skipped(SKY SUN ROOM_GREY ROOM_SHELL, ORL_EFFECT_CAUSTICS_GLASS, 0);
}

/* ---- Surfaces -------------------------------------------------------------------------------- */

static void test_interreflection(void **state)
{
    static const char black[] =
        SKY "void plastic w 0 0 5 0 0 0 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    struct orl_plan plan;
    struct plan_left left;
    (void)state;
    plan_expect_skipped(black, ORL_EFFECT_INTERREFLECTION, 0);
    plan = plan_text(black, &left);
    assert_int_equal(plan.photons_global, 0);
    assert_int_equal(left.omit.most_reflections, 0);
    /* One sheet of white paper in a black room, behind a cupboard. */
    plan_expect_simulated(SKY "void plastic w 0 0 5 0 0 0 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE
                              "void plastic white 0 0 5 .8 .8 .8 0 0\n"
                              "white polygon paper 0 0 12 .2 4.9 0 .4 4.9 0 .4 4.9 .3 .2 4.9 .3\n",
                          ORL_EFFECT_INTERREFLECTION);
    /* 0.2^n / 0.8 of pi times 179 lx is a hundredth of a lux, or a millionth of all, from n = 8. */
    plan =
        plan_text(SKY "void plastic w 0 0 5 .2 .2 .2 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE, NULL);
    assert_in_range(plan.most_reflections, 7, 9);
    plan = plan_of(&(struct plan_query){.text = SKY ROOM,
                                        .effect = ORL_EFFECT_INTERREFLECTION,
                                        .override = ORL_OVERRIDE_SKIP,
                                        .technique = ORL_TECHNIQUE_DIRECT},
                   &left);
    /* With photons for direct light, first landings still count as the sky's direct light. */
    assert_int_equal(plan.most_reflections, 0);
    assert_int_equal(left.omit.most_reflections, 1);
    assert_true(plan.photons_global > 0);
}

static void test_glossy(void **state)
{
    struct orl_plan plan;
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_GLOSSY, 0);
    plan_expect_simulated(SKY ROOM "void plastic s 0 0 5 .5 .5 .5 .02 .1\n"
                                   "s ring spot 0 0 8 2 4 .001 0 0 1 0 .01\n",
                          ORL_EFFECT_GLOSSY);
    plan = plan_of(&(struct plan_query){.text = SKY ROOM "void plastic s 0 0 5 .5 .5 .5 .02 .1\n"
                                                         "s ring spot 0 0 8 2 4 .001 0 0 1 0 .01\n",
                                        .effect = ORL_EFFECT_GLOSSY,
                                        .override = ORL_OVERRIDE_SKIP},
                   &left);
    assert_true(!plan.effects[ORL_EFFECT_GLOSSY].simulated && left.omit.glossy);
    assert_true(plan.effects[ORL_EFFECT_GLOSSY].bound > 1);
}

/* A red wall behind a white one. */
static void test_color(void **state)
{
    static const char red[] =
        SKY SUN ROOM "void plastic red 0 0 5 .6 .1 .1 0 0\n"
                     "red polygon behind 0 0 12 0 4.99 0 4 4.99 0 4 4.99 3 0 4.99 3\n"
                     "w polygon before 0 0 12 0 4.98 0 4 4.98 0 4 4.98 3 0 4.98 3\n";
    struct orl_plan plan;
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_COLOR, 0);
    plan = plan_text(SKY SUN ROOM, &left);
    assert_true(plan.channels == 1 && left.omit.channels == 1);
    plan_expect_simulated(red, ORL_EFFECT_COLOR);
    plan_expect_simulated("void glow g 0 0 4 .9 1 1.1 0\ng source sky 0 0 4 0 0 1 180\n" ROOM,
                          ORL_EFFECT_COLOR);
    plan = plan_of(&(struct plan_query){.text = red,
                                        .effect = ORL_EFFECT_COLOR,
                                        .override = ORL_OVERRIDE_SKIP},
                   &left);
    assert_true(plan.channels == 1 && left.omit.bleached);
    assert_true(plan.effects[ORL_EFFECT_COLOR].bound > 0);
}

static void test_clear_solids(void **state)
{
    static const char bead[] =
        SKY SUN ROOM "void dielectric d 0 0 5 .9 .9 .9 1.5 0\nd sphere bead 0 0 4 2 1.5 .5 .003\n";
    static const char pure[] =
        SKY SUN ROOM "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere bead 0 0 4 2 1.5 .5 .003\n";
    struct orl_plan plan;
    struct plan_left left;
    (void)state;
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_MEDIA, 0);
    plan_expect_skipped(SKY SUN ROOM, ORL_EFFECT_REFRACTION, 0);
    plan_expect_skipped(pure, ORL_EFFECT_MEDIA, 0);
    plan_expect_simulated(pure, ORL_EFFECT_REFRACTION);
    plan_expect_simulated(bead, ORL_EFFECT_MEDIA);
    plan_expect_simulated(bead, ORL_EFFECT_CAUSTICS_MIRROR);
    plan = plan_of(&(struct plan_query){.text = bead,
                                        .effect = ORL_EFFECT_REFRACTION,
                                        .override = ORL_OVERRIDE_SKIP},
                   &left);
    assert_true(left.omit.refraction && plan.effects[ORL_EFFECT_REFRACTION].bound > 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mirrors),
        cmocka_unit_test(test_what_mirrors_may_add),
        cmocka_unit_test(test_mirrors_outside),
        cmocka_unit_test(test_lobes),
        cmocka_unit_test(test_caustics_of_paths),
        cmocka_unit_test(test_glass),
        cmocka_unit_test(test_interreflection),
        cmocka_unit_test(test_glossy),
        cmocka_unit_test(test_color),
        cmocka_unit_test(test_clear_solids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
