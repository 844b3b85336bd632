/*
 * Illums: the secondary source in place of a window transmits suns, and no other light behind it,
 * by all techniques; a material that is neither void nor glass transmits nothing.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#include "support/extent.h"
#include "support/scene_text.h"

#define SKY "void glow sky 0 0 4 100 90 80 0\nsky source s 0 0 4 0 0 1 360\n"
#define SUN "void light sun 0 0 3 4e6 4e6 4e6\nsun source d 0 0 4 .2 -.7 .6 .533\n"
#define GLASS "void glass pane 0 0 3 .8 .8 .8\n"
#define ROOM(rho)                                                                                  \
    "void plastic wall 0 0 5 " rho " " rho " " rho " 0 0\n"                                        \
    "wall polygon w 0 0 12 0 0 0 0 0 3 0 5 3 0 5 0\n"                                              \
    "wall polygon e 0 0 12 4 0 0 4 5 0 4 5 3 4 0 3\n"                                              \
    "wall polygon n 0 0 12 0 5 0 0 5 3 4 5 3 4 5 0\n"                                              \
    "wall polygon u 0 0 12 0 0 3 4 0 3 4 5 3 0 5 3\n"                                              \
    "wall polygon f 0 0 12 0 0 0 0 5 0 4 5 0 4 0 0\n"
#define WINDOW "win polygon s 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"

static const double lumens = 179;

static double run_scene(const char *scene, enum orl_technique technique, double *ret_error)
{
    static const struct orl_sensor sensor = {{1.5, 1, .8}, {0, 0, 1}};
    const bool has_maps = technique != ORL_TECHNIQUE_BACKWARD;
    const struct scene_run job = {.scene = scene,
                                  .sensors = &sensor,
                                  .n_sensors = 1,
                                  .technique = technique,
                                  .overrides = has_maps ? scene_wish_maps : NULL,
                                  .samples = 2048,
                                  .global = extent(100000, 200000),
                                  .threads = 2,
                                  .dark_is_error = false};
    struct orl_result result = scene_run(&job);
    const double lx = result.illuminance_lx[0];
    *ret_error = result.standard_error_lx[0];
    orl_result_done(&result);
    return lx;
}

/* Checks a black room: the sun's disc on the plane, times the pane's transmittance at its angle. */
static void check_sun(const char *illum, double transmitted)
{
    const double cosine = .6 / sqrt(.04 + .49 + .36);
    const double sun = 4e6 * 2 * ORL_PI * (1 - cos(.533 / 2 * ORL_PI / 180)) * cosine * lumens;
    char with[2048], without[2048];
    double error[2];
    snprintf(with, sizeof with, "%s%s", illum, SKY SUN ROOM("0") WINDOW);
    snprintf(without, sizeof without, "%s%s", illum, SKY ROOM("0") WINDOW);
    const double a = run_scene(with, ORL_TECHNIQUE_BACKWARD, &error[0]);
    const double b = run_scene(without, ORL_TECHNIQUE_BACKWARD, &error[1]);
    const double tolerance = 4 * hypot(error[0], error[1]) + 1e-3 * sun;
    if (!(b > 1000 && fabs(a - b - transmitted * sun) < tolerance))
        fail_msg("%g lx with the sun, %g without: %g more, not %g", a, b, a - b, transmitted * sun);
}

static void test_sun_passes(void **state)
{
    (void)state;
    check_sun("void illum win 0 0 3 60 50 40\n", 1);
    check_sun("void illum win 1 void 0 3 60 50 40\n", 1);
    /* Patterns apply to the emitted light. */
    check_sun("void brightfunc dim 2 if(Dz,.5,.25) . 0 0\ndim illum win 1 void 0 3 60 50 40\n", 1);
    check_sun("void plastic paint 0 0 5 .5 .5 .5 0 0\nvoid illum win 1 paint 0 3 60 50 40\n", 0);
}

/* The transmitted fraction is that of the same pane outside an illum. */
static void test_by_glass(void **state)
{
    double error[2];
    (void)state;
    const double bare = run_scene(SUN ROOM("0"), ORL_TECHNIQUE_BACKWARD, &error[0]);
    const double paned = run_scene(SUN GLASS "void alias win pane\n" ROOM("0") WINDOW,
                                   ORL_TECHNIQUE_BACKWARD, &error[1]);
    assert_true(paned > 0 && paned < .9 * bare);
    check_sun(GLASS "void illum win 1 pane 0 3 60 50 40\n", paned / bare);
}

/* The sun's light in a bright room agrees between photons and paths. */
static void test_techniques(void **state)
{
    static const char scene[] =
        SKY SUN GLASS "void illum win 1 pane 0 3 60 50 40\n" ROOM(".6") WINDOW;
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_DIRECT};
    double error[2];
    const double paths = run_scene(scene, ORL_TECHNIQUE_BACKWARD, &error[0]);
    (void)state;
    for (size_t i = 0; i < sizeof techniques / sizeof *techniques; i++) {
        const double maps = run_scene(scene, techniques[i], &error[1]);
        if (!(fabs(maps - paths) < 4 * hypot(error[0], error[1]) && error[1] < .03 * paths))
            fail_msg("technique %zu: %g +- %g lx, not %g", i, maps, error[1], paths);
    }
}

/* Virtual lamps on a bright wall outdoors add nothing through an illum. */
static void test_surfaces_behind(void **state)
{
#define ILLUM_ROOM SKY "void illum win 1 void 0 3 60 50 40\n" ROOM(".6") WINDOW
    static const char alone[] = ILLUM_ROOM;
    static const char before_wall[] =
        ILLUM_ROOM "wall polygon outside 0 0 12 -4 -3 0 -4 -3 6 8 -3 6 8 -3 0\n";
#undef ILLUM_ROOM
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                    ORL_TECHNIQUE_DIRECT};
    double error[2];
    (void)state;
    for (size_t i = 0; i < sizeof techniques / sizeof *techniques; i++) {
        const double expected = run_scene(alone, techniques[i], &error[0]);
        const double lx = run_scene(before_wall, techniques[i], &error[1]);
        print_message("technique %zu: %g +- %g lx, alone %g\n", i, lx, error[1], expected);
        assert_true(fabs(lx - expected) < 4 * hypot(error[0], error[1]));
        assert_true(error[1] < .03 * lx);
    }
}

/* An illum is invisible from behind: a room behind one is lit as through an opening, by all
 * techniques, and its emission goes outdoors only. */
static void test_from_behind(void **state)
{
    static const char open[] = SKY SUN ROOM(".6");
    static const char shut[] = SKY SUN "void brightfunc dim 2 if(Dz,.5,.25) . 0 0\n"
                                       "dim illum win 0 0 3 60 50 40\n" ROOM(
                                           ".6") "win polygon s 0 0 12 4 0 0 4 0 3 0 0 3 0 0 0\n";
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                    ORL_TECHNIQUE_DIRECT};
    double error[2];
    const double paths = run_scene(open, ORL_TECHNIQUE_BACKWARD, &error[0]);
    (void)state;
    for (size_t i = 0; i < sizeof techniques / sizeof *techniques; i++) {
        const double lx = run_scene(shut, techniques[i], &error[1]);
        if (!(fabs(lx - paths) < 4 * hypot(error[0], error[1]) && error[1] < .03 * paths))
            fail_msg("technique %zu: %g +- %g lx, not %g", i, lx, error[1], paths);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sun_passes),  cmocka_unit_test(test_by_glass),
        cmocka_unit_test(test_techniques),  cmocka_unit_test(test_surfaces_behind),
        cmocka_unit_test(test_from_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
