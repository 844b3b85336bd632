/*
 * Number of caustic photons if the job does not set it: according to their yield. A gleam on a
 * ceiling gets few, which cost at most half of the rest of the work; a spot behind a lens keeps its
 * light; panes that scatter the sun get as many as the global map. The plan estimates their cost.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "support/extent.h"
#include "support/room.h"

enum { GLOBAL = 200000 };

/* The gleam with photons by the plan and with many, on three threads; several cases use them. */
static struct orl_result gleam_by_plan, gleam_of_many;

/*
 * A board of 2 % gloss on the floor in the sun; and a ball of glass, 10 cm wide, above the floor.
 */
#define GLOSS                                                                                      \
    "void plastic f 0 0 5 .3 .3 .3 .02 .1\nf polygon gloss 0 0 12 .2 .2 .01 3.8 .2 .01 "           \
    "3.8 4.8 .01 .2 4.8 .01\n"
#define LENS "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere lens 0 0 4 2 1.6 .06 .05\n"
#define ROOM ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE

static struct orl_result run_as(const char *scene, const char *bsdf, uint64_t caustic,
                                uint32_t threads, bool bounded)
{
    /* Behind the ball along the sun's direction, in the sun beside it, and at the ceiling. */
    static const struct orl_sensor sensors[] = {{{2, 1.66, .0001}, {0, 0, 1}},
                                                {{2.6, 1.66, .0001}, {0, 0, 1}},
                                                {{2, 2.5, 2.9999}, {0, 0, -1}},
                                                {{1, 3.5, 2.9999}, {0, 0, -1}}};
    return scene_run(&(struct scene_run){.scene = scene,
                                         .resource_name = bsdf ? "pane.xml" : NULL,
                                         .resource_text = bsdf,
                                         .sensors = sensors,
                                         .n_sensors = 4,
                                         .samples = 1024,
                                         .global = GLOBAL,
                                         .caustic = caustic,
                                         .bounded = bounded,
                                         .threads = threads});
}

static struct orl_result run_job(const char *scene, const char *bsdf, uint64_t caustic,
                                 uint32_t threads)
{
    return run_as(scene, bsdf, caustic, threads, false);
}

static const struct orl_map_info *map_of(const struct orl_result *r, const char *kind)
{
    for (size_t i = 0; i < r->n_maps; i++)
        if (strcmp(r->maps[i].kind, kind) == 0)
            return &r->maps[i];
    return NULL;
}

/*
 * Expects equal light at each sensor within 4 joint standard errors, since 16 batches have tails.
 */
static void expect_same_light(const struct orl_result *a, const struct orl_result *b, size_t first)
{
    for (size_t i = first; i < a->n_sensors; i++) {
        const double bias = fabs(a->bias_estimate_lx[i]) + fabs(b->bias_estimate_lx[i]);
        const double se = hypot(a->standard_error_lx[i], b->standard_error_lx[i]);
        const double off = a->illuminance_lx[i] - b->illuminance_lx[i];
        print_message("sensor %zu: %.1f, by more photons %.1f, standard error %.1f, bias %.1f\n", i,
                      a->illuminance_lx[i], b->illuminance_lx[i], se, bias);
        assert_true(fabs(off) <= 4 * se + bias);
    }
}

/* The pilot has some 2048 photons of that kind: 2 %, and rounds of batches end a little late. */
static void expect_foreseen(const struct orl_result *r)
{
    const struct orl_photon_forecast *f = &r->plan.forecast;
    assert_true(f->made && f->known);
    assert_true(f->job_s > f->photons_s && isfinite(f->job_s));
    const char *const kinds[] = {"global", "caustic"};
    for (int k = 0; k < 2; k++) {
        const double emitted = (double)map_of(r, kinds[k])->emitted;
        print_message("%s: %.3g emissions foreseen, %.3g made\n", kinds[k], f->emitted[k], emitted);
        assert_true(f->emitted[k] > 0.8 * emitted - 8192 && f->emitted[k] < 1.2 * emitted);
    }
}

static void test_a_gleam_gets_few(void **state)
{
    (void)state;
    const struct orl_map_info *global = map_of(&gleam_by_plan, "global"),
                              *caustic = map_of(&gleam_by_plan, "caustic");
    print_message("%llu caustic photons of %llu emissions; global %llu of %llu\n",
                  (unsigned long long)caustic->stored, (unsigned long long)caustic->emitted,
                  (unsigned long long)global->stored, (unsigned long long)global->emitted);
    assert_true(caustic->stored < GLOBAL / 4);
    assert_true(caustic->emitted < 4 * global->emitted);
    expect_foreseen(&gleam_by_plan);
    expect_same_light(&gleam_by_plan, &gleam_of_many, 2); /* the others lie under the board */
}

static void test_a_spot_is_kept(void **state)
{
    (void)state;
    struct orl_result r = run_job(ROOM LENS, NULL, ORL_PHOTONS_BY_PLAN, 2);
    struct orl_result more = run_job(ROOM LENS, NULL, GLOBAL, 2);
    assert_true(r.illuminance_lx[0] > 2 * r.illuminance_lx[1]);
    expect_foreseen(&r);
    expect_same_light(&r, &more, 0);
    orl_result_done(&r);
    orl_result_done(&more);
}

/*
 * The light of a lamp passes a prism onto black walls, and through and beside it onto the floor. A
 * caustic photon takes 48 emissions, and those that land are worth as many as the global ones. The
 * planned photons take rays in proportion to the error that they may reduce.
 */
static void test_a_prism_is_bounded(void **state)
{
    static const char scene[] =
        "void plastic wall 0 0 5 .5 .5 .5 0 0\nvoid plastic black 0 0 5 0 0 0 0 0\n"
        "!genbox black room 4 4 3 -i\n"
        "wall polygon w 0 0 12 0 0 .001 4 0 .001 4 4 .001 0 4 .001\n"
        "void dielectric glass 0 0 5 1 1 1 1.5 0\n"
        "!genprism glass prism 3 0 0 .2 0 .1 .17 -l 0 0 .5 | xform -t 1.5 2 1\n"
        "void spotlight lamp 0 0 7 1000 1000 1000 100 -1 0 -.5\n"
        "lamp ring bulb 0 0 8 2.4 2.1 1.8 -1 0 -.5 0 .03\n";
    (void)state;
    struct orl_result r = run_job(scene, NULL, ORL_PHOTONS_BY_PLAN, 2);
    const struct orl_map_info *global = map_of(&r, "global"), *caustic = map_of(&r, "caustic");
    print_message("%llu caustic photons of %llu emissions; global %llu of %llu; %s\n",
                  (unsigned long long)caustic->stored, (unsigned long long)caustic->emitted,
                  (unsigned long long)global->stored, (unsigned long long)global->emitted,
                  r.plan.forecast.why);
    assert_true(caustic->stored >= 20000); /* a full map */
    assert_true(caustic->emitted <= 4 * global->emitted);
    expect_foreseen(&r);
    orl_result_done(&r);
}

static void test_scattering_panes_get_all(void **state)
{
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    struct orl_result r = run_job(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE, xml,
                                  ORL_PHOTONS_BY_PLAN, 2);
    assert_int_equal(r.plan.photons_caustic, GLOBAL);
    expect_foreseen(&r);
    orl_result_done(&r);
}

static bool says(const struct orl_result *r, const char *words)
{
    for (size_t i = 0; i < r->n_warnings; i++)
        if (strstr(r->warnings[i], words))
            return true;
    return false;
}

/* A million photons of a gleam are limited by their yield, in time and with a warning; those of a
 * lens are not, and neither are those that take no longer than a pilot. */
static void test_askers_are_bounded(void **state)
{
    (void)state;
    struct orl_result gleam = run_as(ROOM GLOSS, NULL, 1000000, 2, true);
    struct orl_result spot = run_as(ROOM LENS, NULL, GLOBAL / 2, 2, true);
    struct orl_result few = run_as(ROOM GLOSS, NULL, 5000, 2, true);
    const struct orl_map_info *global = map_of(&gleam, "global"),
                              *caustic = map_of(&gleam, "caustic");
    print_message("%llu of 1000000, %llu of %d photons\n",
                  (unsigned long long)gleam.plan.photons_caustic,
                  (unsigned long long)spot.plan.photons_caustic, GLOBAL / 2);
    assert_true(gleam.plan.photons_caustic < 200000);
    assert_true(caustic->stored >= gleam.plan.photons_caustic);
    assert_true(caustic->emitted < 4 * global->emitted);
    assert_true(says(&gleam, "of 1000000 requested caustic photons"));
    expect_same_light(&gleam, &gleam_of_many, 2);
    assert_int_equal(spot.plan.photons_caustic, GLOBAL / 2);
    assert_false(says(&spot, "requested caustic photons"));
    assert_int_equal(few.plan.photons_caustic, 5000);
    orl_result_done(&gleam);
    orl_result_done(&spot);
    orl_result_done(&few);
}

/* A job with an exact number gets that number; no number depends on the number of threads. */
static void test_numbers(void **state)
{
    (void)state;
    struct orl_result asked = run_job(ROOM GLOSS, NULL, 5000, 1);
    struct orl_result one = run_job(ROOM GLOSS, NULL, ORL_PHOTONS_BY_PLAN, 1);
    const struct orl_result *const three = &gleam_by_plan;
    assert_int_equal(asked.plan.photons_caustic, 5000);
    assert_false(asked.plan.forecast.made);
    assert_true(map_of(&asked, "caustic")->stored >= 5000);
    assert_true(one.plan.photons_caustic == three->plan.photons_caustic);
    assert_string_equal(one.plan.forecast.why, three->plan.forecast.why);
    for (size_t i = 0; i < one.n_sensors; i++)
        assert_true(one.illuminance_lx[i] == three->illuminance_lx[i]);
    orl_result_done(&asked);
    orl_result_done(&one);
}

static int run_gleams(void **state)
{
    (void)state;
    gleam_by_plan = run_job(ROOM GLOSS, NULL, ORL_PHOTONS_BY_PLAN, 3);
    gleam_of_many = run_job(ROOM GLOSS, NULL, extent(50000, 100000), 3);
    return 0;
}

static int drop_gleams(void **state)
{
    (void)state;
    orl_result_done(&gleam_by_plan);
    orl_result_done(&gleam_of_many);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_gleam_gets_few),   cmocka_unit_test(test_a_spot_is_kept),
        cmocka_unit_test(test_a_prism_is_bounded), cmocka_unit_test(test_scattering_panes_get_all),
        cmocka_unit_test(test_askers_are_bounded), cmocka_unit_test(test_numbers)};
    return cmocka_run_group_tests(tests, run_gleams, drop_gleams);
}
