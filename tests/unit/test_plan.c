/*
 * Plans: of every effect a scene that does not call for it, and one that does but where it is
 * easily missed; wishes; and that a plan is the same for any crew. Every reason holds a number.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "plan/plan.h"
#include "support/room.h"

#define SKY ROOM_SKY
#define SUN ROOM_SUN
#define NORTH_SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 1 1 .533\n"
#define SECOND_NORTH_SUN "l source sun2 0 0 4 .2 1 1 .533\n"
#define ROOM ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
/* A block of flats opposite, 200 m off, 2 m of it above the sill. */
#define OPPOSITE "w polygon flats 0 0 12 -1 -200 0 5 -200 0 5 -200 3 -1 -200 3\n"
/* What light meets in one place of the sun's patch only: the sun comes in at 45 degrees. */
#define DISH "void mirror m 0 0 3 .9 .9 .9\nm cup dish 0 0 8 2 1.5 .02 2 1.5 .03 .002 .012\n"
#define DISH_IN_SHADE "void mirror m 0 0 3 .9 .9 .9\nm cup dish 0 0 8 2 .5 .02 2 .5 .03 .002 .012\n"

struct query {
    const char *text;
    const char *bsdf; /* of pane.xml */
    enum orl_technique technique;
    enum orl_effect effect; /* with a wish for it */
    enum orl_wish wish;
    bool view;
    uint32_t threads;
    uint64_t caustic;
    const struct orl_sensor *sensor;
};

/* What the world was left with, beside the plan. */
struct left {
    size_t suns, domes, emitters;
    struct orl_omissions omit;
    bool caustics_lit, clear, silent;
};

static bool holds_number(const char *why)
{
    return strpbrk(why, "0123456789") != NULL;
}

/* Goes on whenever it is looked at. */
static double tick(void *ctx)
{
    double *now = ctx;
    return *now += 0.001;
}

static struct orl_plan plan_of(const struct query *q, struct left *ret_left)
{
    static char name[] = "v", view[] = "-vtv -vp 2 4 1.5 -vd 0 -1 0";
    struct orl_view_request views[1] = {{.name = name, .view = view, .width = 64, .height = 48}};
    static const struct orl_sensor inside = {{2, 2.5, .8}, {0, 0, 1}};
    struct orl_crew *crew = orl_crew_start(q->threads ? q->threads : 1);
    struct orl_world *all = scene_world(q->text, q->bsdf ? "pane.xml" : NULL, q->bsdf, crew);
    struct orl_world *world = NULL;
    struct orl_plan plan;
    struct orl_job job;
    double now = 0;
    orl_job_init(&job);
    job.technique = q->technique;
    job.wishes[q->effect] = q->wish;
    job.photons_caustic = q->caustic ? q->caustic : ORL_PHOTONS_BY_PLAN;
    job.views = q->view ? views : NULL;
    job.n_views = q->view;
    const struct orl_plan_request request = {.job = &job,
                                             .sensors = q->sensor ? q->sensor : &inside,
                                             .n_sensors = q->view ? 0 : 1,
                                             .crew = crew,
                                             .now_s = tick,
                                             .ctx = &now};
    assert_int_equal(orl_plan_make(&request, all->lights, &plan, &world, NULL), 0);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        if (!holds_number(plan.effects[i].why) || plan.effects[i].bound < 0)
            fail_msg("%s: '%s', bound %g", orl_effect_name((enum orl_effect)i), plan.effects[i].why,
                     plan.effects[i].bound);
    if (ret_left)
        *ret_left = (struct left){.suns = world->n_suns,
                                  .domes = world->n_domes,
                                  .emitters = world->n_emitters,
                                  .omit = world->omit,
                                  .caustics_lit = world->caustics_lit,
                                  .clear = world->n_ports > 0 && world->ports[0].clear,
                                  .silent = world->n_ports > 0 && world->ports[0].silent};
    orl_world_free(world);
    orl_world_free(all);
    orl_crew_stop(crew);
    return plan;
}

static struct orl_plan plan_text(const char *text, struct left *ret_left)
{
    return plan_of(&(struct query){.text = text}, ret_left);
}

/* Skipped of its own accord, at no more than that cost; or simulated. */
static void expect_skipped(const char *text, enum orl_effect effect, double bound)
{
    const struct orl_plan plan = plan_text(text, NULL);
    const struct orl_decision *d = &plan.effects[effect];
    if (d->simulated || d->bound > bound)
        fail_msg("%s is simulated, or may cost %g: %s", orl_effect_name(effect), d->bound, d->why);
}

static void expect_simulated(const char *text, enum orl_effect effect)
{
    const struct orl_plan plan = plan_text(text, NULL);
    const struct orl_decision *d = &plan.effects[effect];
    if (!d->simulated || !(d->bound > 0))
        fail_msg("%s is skipped, or costs nothing: %s", orl_effect_name(effect), d->why);
}

/* ---- Lights ---------------------------------------------------------------------------------- */

static void test_sun(void **state)
{
    struct left left;
    (void)state;
    expect_skipped(SKY ROOM, ORL_EFFECT_SUN, 0);
    /* Half a degree in front of the pane's plane, and weak. */
    expect_simulated(SKY ROOM "void light l 0 0 3 10 10 10\nl source sun 0 0 4 1 -.005 1 .533\n",
                     ORL_EFFECT_SUN);
    plan_text(SKY NORTH_SUN ROOM, &left);
    assert_int_equal(left.suns, 0);
}

/* Behind the house, with nothing outside, no sun comes in; a house opposite sends it in. */
static void test_suns(void **state)
{
    struct left left;
    (void)state;
    expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_SUNS, 0);
    expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_SUN, 0);
    expect_simulated(SKY NORTH_SUN ROOM OPPOSITE, ORL_EFFECT_SUNS);
    expect_simulated(SKY NORTH_SUN ROOM OPPOSITE, ORL_EFFECT_SUN);
    plan_text(SKY SUN SECOND_NORTH_SUN ROOM, &left);
    assert_int_equal(left.suns, 1);
    plan_text(SKY SUN SECOND_NORTH_SUN ROOM OPPOSITE, &left);
    assert_int_equal(left.suns, 2);
}

/* On the roof it shines all the same; and so it does through a hole of 10 x 10 cm in the north. */
static void test_suns_that_are_seen(void **state)
{
    static const struct orl_sensor roof = {{2, 2.5, 3.2}, {0, 0, 1}};
    struct left left;
    (void)state;
    plan_of(&(struct query){.text = SKY NORTH_SUN ROOM, .sensor = &roof}, &left);
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
    struct left left;
    (void)state;
    expect_skipped(SUN ROOM, ORL_EFFECT_SKY, 0);
    /* A ten-millionth of a watt beside the sun is 6e-5 lx; by itself it is all there is. */
    expect_skipped("void glow g 0 0 4 1e-7 1e-7 1e-7 0\ng source sky 0 0 4 0 0 1 180\n" SUN ROOM,
                   ORL_EFFECT_SKY, 0.01);
    expect_simulated("void glow g 0 0 4 1e-7 1e-7 1e-7 0\ng source sky 0 0 4 0 0 1 180\n" ROOM,
                     ORL_EFFECT_SKY);
    plan_text(SUN ROOM, &left);
    assert_int_equal(left.domes, 0);
}

static void test_lamps(void **state)
{
    struct left left;
    (void)state;
    expect_skipped(SKY ROOM, ORL_EFFECT_LAMPS, 0);
    expect_skipped(SKY SUN ROOM
                   "void light dim 0 0 3 1e-6 1e-6 1e-6\ndim sphere s 0 0 4 2 2 2 .1\n",
                   ORL_EFFECT_LAMPS, 0.01);
    expect_simulated(SKY SUN ROOM "void light led 0 0 3 50 50 50\nled sphere s 0 0 4 2 2 2 .001\n",
                     ORL_EFFECT_LAMPS);
    plan_text(SKY SUN ROOM "void light dim 0 0 3 1e-6 1e-6 1e-6\ndim sphere s 0 0 4 2 2 2 .1\n",
              &left);
    assert_int_equal(left.emitters, 0);
}

/* ---- Windows --------------------------------------------------------------------------------- */

static void test_exterior(void **state)
{
    struct left left;
    (void)state;
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_EXTERIOR, 0);
    expect_simulated(SKY SUN ROOM OPPOSITE, ORL_EFFECT_EXTERIOR);
    /* A sill that stands out by 5 cm. */
    expect_simulated(SKY SUN ROOM "w polygon sill 0 0 12 1 -.05 1 3 -.05 1 3 0 1 1 0 1\n",
                     ORL_EFFECT_EXTERIOR);
    /* Black, it shades and reflects nothing. */
    expect_skipped(SKY SUN ROOM "void plastic k 0 0 5 0 0 0 0 0\n"
                                "k polygon sill 0 0 12 1 -.05 1 3 -.05 1 3 0 1 1 0 1\n",
                   ORL_EFFECT_EXTERIOR, 0);
    /* But the panes do, and who stands before them sees it. */
    static const struct orl_sensor before = {{2, -.5, 1.5}, {0, 1, 0}};
    const struct orl_plan seen =
        plan_of(&(struct query){.text = SKY SUN ROOM "void plastic k 0 0 5 0 0 0 0 0\n"
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

/* The only light stands about the northern horizon, or reaches a little round to the south. */
static void test_ports(void **state)
{
    struct left left;
    (void)state;
    expect_skipped("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM, ORL_EFFECT_PORTS,
                   0);
    plan_text("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM, &left);
    assert_true(left.silent);
    expect_simulated("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 182\n" ROOM,
                     ORL_EFFECT_PORTS);
    expect_simulated("void glow g 0 0 4 1 1 1 0\ng source n 0 0 4 0 1 0 60\n" ROOM OPPOSITE,
                     ORL_EFFECT_PORTS);
}

/* ---- Caustics -------------------------------------------------------------------------------- */

static void test_mirrors(void **state)
{
    struct left left;
    struct orl_plan plan;
    (void)state;
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    expect_skipped(SKY ROOM DISH, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    expect_skipped(SKY SUN ROOM DISH_IN_SHADE, ORL_EFFECT_CAUSTICS_MIRROR, 0);
    expect_simulated(SKY SUN ROOM DISH, ORL_EFFECT_CAUSTICS_MIRROR);
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
    expect_simulated(SKY SUN ROOM DISH_IN_SHADE
                     "void light led 0 0 3 50 50 50\nled sphere s 0 0 4 2 2 2 .01\n",
                     ORL_EFFECT_CAUSTICS_MIRROR);
}

/* A small pane of a house opposite throws the northern sun into the window. */
static void test_mirrors_outside(void **state)
{
    (void)state;
    expect_simulated(SKY NORTH_SUN ROOM "void mirror m 0 0 3 .9 .9 .9\n"
                                        "m polygon q 0 0 12 2.2 -9 10.5 1.8 -9 10.5 1.8 -9 10.9 "
                                        "2.2 -9 10.9\n",
                     ORL_EFFECT_CAUSTICS_MIRROR);
    /* Lower down it throws it at the wall below: shadow rays see to that, without photons. */
    struct left left;
    const struct orl_plan plan =
        plan_of(&(struct query){.text = SKY NORTH_SUN ROOM
                                "void mirror m 0 0 3 .9 .9 .9\n"
                                "m polygon q 0 0 12 2.2 -9 8.5 1.8 -9 8.5 1.8 -9 8.9 2.2 -9 8.9\n",
                                .technique = ORL_TECHNIQUE_GATHER},
                &left);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_MIRROR].simulated);
    assert_false(left.caustics_lit);
    assert_int_equal(plan.photons_caustic, 0);
    /* With nothing outside for it to be thrown at there is nothing to simulate. */
    expect_skipped(SKY NORTH_SUN ROOM, ORL_EFFECT_CAUSTICS_MIRROR, 0);
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
    plan = plan_of(&(struct query){.text = small, .bsdf = bsdf}, NULL);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].simulated);
    assert_true(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].bound > 0);
    /* The same window, and the sun behind the house. */
    plan = plan_of(&(struct query){.text = SKY NORTH_SUN ROOM_GREY ROOM_SHELL ROOM_BSDF ROOM_PANE,
                                   .bsdf = bsdf},
                   NULL);
    assert_false(plan.effects[ORL_EFFECT_CAUSTICS_BSDF].simulated);
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_CAUSTICS_BSDF, 0);
    /* Rough steel, a coin of it, in the sun's patch. */
    expect_simulated(SKY SUN ROOM "void metal s 0 0 5 .6 .6 .6 .9 .1\n"
                                  "s ring coin 0 0 8 2 1.5 .001 0 0 1 0 .01\n",
                     ORL_EFFECT_CAUSTICS_BSDF);
}

/* What a technique cannot leave out it does not claim to. */
static void test_caustics_of_paths(void **state)
{
    const struct orl_plan plan = plan_of(&(struct query){.text = SKY SUN ROOM DISH,
                                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                                         .effect = ORL_EFFECT_CAUSTICS_MIRROR,
                                                         .wish = ORL_WISH_SKIP},
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
    expect_skipped(SKY SUN ROOM_GREY ROOM_SHELL, ORL_EFFECT_CAUSTICS_GLASS, 0);
}

/* ---- Surfaces -------------------------------------------------------------------------------- */

static void test_interreflection(void **state)
{
    static const char black[] =
        SKY "void plastic w 0 0 5 0 0 0 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    struct orl_plan plan;
    struct left left;
    (void)state;
    expect_skipped(black, ORL_EFFECT_INTERREFLECTION, 0);
    plan = plan_text(black, &left);
    assert_int_equal(plan.photons_global, 0);
    assert_int_equal(left.omit.most_reflections, 0);
    /* One sheet of white paper in a black room, behind a cupboard. */
    expect_simulated(SKY "void plastic w 0 0 5 0 0 0 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE
                         "void plastic white 0 0 5 .8 .8 .8 0 0\n"
                         "white polygon paper 0 0 12 .2 4.9 0 .4 4.9 0 .4 4.9 .3 .2 4.9 .3\n",
                     ORL_EFFECT_INTERREFLECTION);
    /* 0.2^n / 0.8 of pi times 179 lx is a hundredth of a lux, or a millionth of all, from n = 8. */
    plan =
        plan_text(SKY "void plastic w 0 0 5 .2 .2 .2 0 0\n" ROOM_CLEAR ROOM_SHELL ROOM_PANE, NULL);
    assert_in_range(plan.most_reflections, 7, 9);
    plan = plan_of(&(struct query){.text = SKY ROOM,
                                   .effect = ORL_EFFECT_INTERREFLECTION,
                                   .wish = ORL_WISH_SKIP,
                                   .technique = ORL_TECHNIQUE_DIRECT},
                   &left);
    /* Of direct photons those that land first are still the sky's own. */
    assert_int_equal(plan.most_reflections, 0);
    assert_int_equal(left.omit.most_reflections, 1);
    assert_true(plan.photons_global > 0);
}

static void test_glossy(void **state)
{
    struct orl_plan plan;
    struct left left;
    (void)state;
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_GLOSSY, 0);
    expect_simulated(SKY ROOM "void plastic s 0 0 5 .5 .5 .5 .02 .1\n"
                              "s ring spot 0 0 8 2 4 .001 0 0 1 0 .01\n",
                     ORL_EFFECT_GLOSSY);
    plan = plan_of(&(struct query){.text = SKY ROOM "void plastic s 0 0 5 .5 .5 .5 .02 .1\n"
                                                    "s ring spot 0 0 8 2 4 .001 0 0 1 0 .01\n",
                                   .effect = ORL_EFFECT_GLOSSY,
                                   .wish = ORL_WISH_SKIP},
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
    struct left left;
    (void)state;
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_COLOR, 0);
    plan = plan_text(SKY SUN ROOM, &left);
    assert_true(plan.channels == 1 && left.omit.channels == 1);
    expect_simulated(red, ORL_EFFECT_COLOR);
    expect_simulated("void glow g 0 0 4 .9 1 1.1 0\ng source sky 0 0 4 0 0 1 180\n" ROOM,
                     ORL_EFFECT_COLOR);
    plan = plan_of(&(struct query){.text = red, .effect = ORL_EFFECT_COLOR, .wish = ORL_WISH_SKIP},
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
    struct left left;
    (void)state;
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_MEDIA, 0);
    expect_skipped(SKY SUN ROOM, ORL_EFFECT_REFRACTION, 0);
    expect_skipped(pure, ORL_EFFECT_MEDIA, 0);
    expect_simulated(pure, ORL_EFFECT_REFRACTION);
    expect_simulated(bead, ORL_EFFECT_MEDIA);
    expect_simulated(bead, ORL_EFFECT_CAUSTICS_MIRROR);
    plan = plan_of(
        &(struct query){.text = bead, .effect = ORL_EFFECT_REFRACTION, .wish = ORL_WISH_SKIP},
        &left);
    assert_true(left.omit.refraction && plan.effects[ORL_EFFECT_REFRACTION].bound > 1);
}

/* ---- Requests -------------------------------------------------------------------------------- */

/* One of a thing is not several. */
static void test_singular(void **state)
{
    (void)state;
    const struct orl_plan plan = plan_of(&(struct query){.text = SKY SUN ROOM, .view = true}, NULL);
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
    assert_true(holds_number(plan.technique_why));
    plan = plan_of(&(struct query){.text = SKY SUN ROOM, .view = true}, NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_GATHER);
    assert_true(plan.effects[ORL_EFFECT_FINAL_GATHER].simulated);
    plan = plan_of(&(struct query){.text = SKY SUN ROOM,
                                   .view = true,
                                   .effect = ORL_EFFECT_FINAL_GATHER,
                                   .wish = ORL_WISH_SKIP},
                   NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_DIRECT);
    assert_false(plan.effects[ORL_EFFECT_FINAL_GATHER].simulated);
    plan = plan_of(&(struct query){.text = SKY SUN ROOM,
                                   .effect = ORL_EFFECT_FINAL_GATHER,
                                   .wish = ORL_WISH_FORCE},
                   NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_GATHER);
    plan = plan_of(
        &(struct query){.text = SKY SUN ROOM DISH, .technique = ORL_TECHNIQUE_PRECOMPUTED}, NULL);
    assert_int_equal(plan.technique, ORL_TECHNIQUE_PRECOMPUTED);
    assert_int_equal(plan.photons_global, ORL_DEFAULT_PHOTONS);
    plan = plan_of(&(struct query){.text = SKY SUN ROOM DISH, .caustic = 1234}, NULL);
    assert_int_equal(plan.photons_caustic, 1234);
}

/* Everything there is, in one room. */
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
        const struct orl_plan forced = plan_of(
            &(struct query){.text = SKY ROOM, .effect = effect, .wish = ORL_WISH_FORCE}, NULL);
        const struct orl_plan skipped = plan_of(
            &(struct query){.text = all_of_it, .effect = effect, .wish = ORL_WISH_SKIP}, NULL);
        const struct orl_plan planned = plan_text(all_of_it, NULL);
        assert_int_equal(forced.effects[i].wish, ORL_WISH_FORCE);
        assert_int_equal(skipped.effects[i].wish, ORL_WISH_SKIP);
        assert_int_equal(forced.effects[i].simulated, !fixed);
        /* Straight through panes goes by shadow rays: it cannot be left out. */
        assert_int_equal(skipped.effects[i].simulated, effect == ORL_EFFECT_CAUSTICS_GLASS);
        assert_int_equal(planned.effects[i].simulated, !fixed);
        if (planned.effects[i].unit != ORL_BOUND_NONE && effect != ORL_EFFECT_CAUSTICS_GLASS)
            assert_true(skipped.effects[i].bound > 0);
    }
}

static void test_skips_are_done(void **state)
{
    struct left left;
    (void)state;
    plan_of(&(struct query){.text = all_of_it, .effect = ORL_EFFECT_SUN, .wish = ORL_WISH_SKIP},
            &left);
    assert_int_equal(left.suns, 0);
    plan_of(&(struct query){.text = all_of_it, .effect = ORL_EFFECT_SKY, .wish = ORL_WISH_SKIP},
            &left);
    assert_int_equal(left.domes, 0);
    plan_of(&(struct query){.text = all_of_it, .effect = ORL_EFFECT_LAMPS, .wish = ORL_WISH_SKIP},
            &left);
    assert_int_equal(left.emitters, 0);
    plan_of(
        &(struct query){.text = all_of_it, .effect = ORL_EFFECT_EXTERIOR, .wish = ORL_WISH_SKIP},
        &left);
    assert_true(left.omit.exterior);
    plan_of(&(struct query){.text = all_of_it, .effect = ORL_EFFECT_PORTS, .wish = ORL_WISH_SKIP},
            &left);
    assert_true(left.silent);
    plan_of(
        &(struct query){.text = SKY ROOM, .effect = ORL_EFFECT_EXTERIOR, .wish = ORL_WISH_FORCE},
        &left);
    assert_false(left.clear);
}

/* The same for any crew, but for the seconds. */
static void test_threads(void **state)
{
    struct orl_plan one = plan_of(&(struct query){.text = all_of_it, .threads = 1}, NULL);
    struct orl_plan three = plan_of(&(struct query){.text = all_of_it, .threads = 3}, NULL);
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

/* A diffuse room without sun or colour plans none of either. */
static void test_plain_room(void **state)
{
    struct left left;
    const struct orl_plan plan = plan_of(&(struct query){.text = SKY ROOM, .view = true}, &left);
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
        cmocka_unit_test(test_mirrors),
        cmocka_unit_test(test_mirrors_outside),
        cmocka_unit_test(test_lobes),
        cmocka_unit_test(test_caustics_of_paths),
        cmocka_unit_test(test_glass),
        cmocka_unit_test(test_interreflection),
        cmocka_unit_test(test_glossy),
        cmocka_unit_test(test_color),
        cmocka_unit_test(test_clear_solids),
        cmocka_unit_test(test_singular),
        cmocka_unit_test(test_techniques),
        cmocka_unit_test(test_wishes),
        cmocka_unit_test(test_skips_are_done),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_plain_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
