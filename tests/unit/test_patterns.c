/*
 * Function patterns on plastic and metal: values at hits, clamping, means and bounds, cache keys
 * of files, and whole jobs against floors of two polygons with plain materials.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/built/scene.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"

/* ---- Values -----------------------------------------------------------------------------------
 */

static int parse(const char *text, const char *function, struct orl_parsed_scene *ret,
                 struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "part.rad", "f.cal"};
    static const char part[] = "tiled polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n";
    const struct orl_file contents[] = {{text, strlen(text), NULL},
                                        {part, sizeof part - 1, NULL},
                                        {function, strlen(function), NULL}};
    struct orl_memory_files memory = {names, contents, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret, err);
}

static struct orl_scene *load(const char *text, const char *function)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    if (parse(text, function, &parsed_scene, &err) < 0 ||
        orl_scene_new(&parsed_scene, &scene, &err) < 0)
        fail_msg("%s", err.message);
    return scene;
}

/* Returns the diffuse reflectance where a ray from above or below hits that place, in the file's
 * coordinates. */
static struct orl_rgb seen(const struct orl_scene *scene, double x, double y, double z, double dz)
{
    struct orl_hit hit;
    const struct orl_vec3 origin = orl_sub(orl_v3(x, y, z - dz), scene->geometry->center);
    assert_true(orl_geometry_intersect(scene->geometry, origin, orl_v3(0, 0, dz), 100, &hit));
    return orl_material_diffuse(orl_scene_material(scene, hit.facet), &hit);
}

static void check_color(struct orl_rgb value, double r, double g, double b)
{
    const double most = fmax(fabs(value.r - r), fmax(fabs(value.g - g), fabs(value.b - b)));
    if (!(most < 1e-5)) /* hits are computed from floats */
        fail_msg("%g %g %g, not %g %g %g", value.r, value.g, value.b, r, g, b);
}

/* Patterns are evaluated in the function's own frame, for any transform of the pattern and of
 * commands. */
static void test_values(void **state)
{
    static const char plain[] = "void brightfunc f 8 value f.cal -s 2 -t 1 0 0 0 2 .5 .25\n"
                                "f plastic tiled 0 0 5 .8 .4 .2 .1 0\n"
                                "tiled polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n";
    static const char moved[] = "void brightfunc f 2 value f.cal 0 2 .5 .25\n"
                                "f plastic tiled 0 0 5 .8 .4 .2 .1 0\n!xform -t 0 0 7 part.rad\n";
    static const char turned[] = "void colorfunc f 6 Px Nz*Nz Tz . -rz 90 0 0\n"
                                 "f metal tiled 0 0 5 .8 .5 .5 0 0\n"
                                 "tiled polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n";
    static const char function[] = "value = A1 + A2*Px; other = 2;";
    (void)state;
    struct orl_scene *scene = load(plain, function);
    for (double x = .5; x < 4; x++) {
        const double factor = .9 * (.5 + .25 * (x - 1) / 2);
        check_color(seen(scene, x, 1, 0, -1), .8 * factor, .4 * factor, .2 * factor);
        check_color(seen(scene, x, 1, 0, 1), .8 * factor, .4 * factor, .2 * factor);
    }
    orl_scene_release(scene);
    scene = load("void brightfunc f 2 .5+.25*Nz . 0 0\n" /* the front's normal, also from behind */
                 "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n",
                 "");
    check_color(seen(scene, 1, 1, 0, -1), .6, .3, .15);
    check_color(seen(scene, 1, 1, 0, 1), .6, .3, .15);
    orl_scene_release(scene);
    scene = load(moved, function); /* only the surfaces are moved: the pattern stays */
    check_color(seen(scene, 2, 1, 7, -1), .72, .36, .18);
    orl_scene_release(scene);
    scene = load(turned, function);
    check_color(seen(scene, 1, .5, 0, -1), .4, .5, 0);
    orl_scene_release(scene);
}

/* Values above the albedo limit and below zero are clamped, and undefined ones ignored with a
 * warning. */
static void test_cut(void **state)
{
    static const char text[] = "void brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n";
    struct orl_scene *const scene =
        load(text, "value = if(Px-3, 4, if(Px-2, -1, if(Px-1, 1/0, .5)));");
    (void)state;
    check_color(seen(scene, 3.5, 1, 0, -1), 1, 1, .8);
    check_color(seen(scene, 2.5, 1, 0, -1), 0, 0, 0);
    check_color(seen(scene, 1.5, 1, 0, -1), .8, .4, .2);
    check_color(seen(scene, .5, 1, 0, -1), .4, .2, .1);
    assert_int_equal(scene->parsed_scene.n_warnings, 1);
    int without = 0;
    assert_int_equal(sscanf(scene->parsed_scene.warnings[0],
                            "a.rad:1: the function of brightfunc f has no value at %d of 1024 "
                            "points",
                            &without),
                     1);
    assert_in_range(without, 246, 266); /* a fourth, to 1 % */
    orl_scene_release(scene);
}

/* At an unspecified place the pattern has its mean; bounds use its maximum. 1 024 places give a
 * share of the area to 1/1024 and a gradient to 1/2048 of its range. */
static void test_bounds(void **state)
{
    static const char text[] = "void brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .5 .5 .5 0 0\n!xform part.rad\n"
                               "tiled sphere ball 0 0 4 -50 -50 0 1e-6\n";
    struct orl_scene *const scene = load(text, "value = if(Px-3, 1.5, Px/3);");
    const struct orl_material *const material = orl_scene_material(scene, 0);
    const struct orl_hit hit = orl_hit_surface_mean(orl_v3(0, 0, 1), true);
    (void)state;
    const double mean = .5 * (.25 * 1.5 + .75 * .5);
    assert_true(fabs(orl_material_diffuse(material, &hit).g - mean) < .002);
    assert_true(fabs(orl_material_max_diffuse(material) - .75) < 1e-9);
    assert_true(fabs(orl_material_max_albedo(material, true, 1, ORL_LOBE_ALL) - .75) < 1e-9);
    orl_scene_release(scene);
}

/* An endless recursion gives an error with its place. */
static void test_endless(void **state)
{
    static const char text[] = "\nvoid brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n";
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    (void)state;
    assert_int_equal(parse(text, "value = g(Px); g(x) = g(x + 1);", &parsed_scene, &err), 0);
    assert_int_equal(orl_scene_new(&parsed_scene, &scene, &err), ORL_ERR_LIMIT);
    assert_string_equal(err.file, "a.rad");
    assert_int_equal(err.line, 2);
    assert_string_equal(err.primitive, "brightfunc f");
}

/* A mistake in a function file gives an error with its place. */
static void test_file_errors(void **state)
{
    static const char text[] = "void brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n";
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse(text, "a = 1;\nvalue = a +;", &parsed_scene, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "f.cal");
    assert_int_equal(err.line, 2);
    assert_string_equal(err.primitive, "brightfunc f");
    assert_int_equal(parse(text, "a = 1;\nvalue = b + a;", &parsed_scene, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, "f.cal");
    assert_int_equal(err.line, 2);
}

/* Every byte of a function file changes the map key; a pattern used twice counts once. */
static void test_keys(void **state)
{
    static const char text[] = "void brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n"
                               "void brightfunc f 2 value f.cal 0 0\n"
                               "f plastic tiled 0 0 5 .8 .4 .2 0 0\n!xform part.rad\n"
                               "void brightfunc f 2 value f.cal 0 1 2\n";
    static const char *const functions[] = {"value = .5;", "value = .6;", "value = .5; "};
    struct orl_parsed_scene d[3] = {{0}};
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 3; i++)
        assert_int_equal(parse(text, functions[i], &d[i], &err), 0);
    assert_int_equal(d[0].n_patterns, 2);
    assert_int_equal(d[0].n_materials, 1);
    assert_true(memcmp(d[0].digest, d[1].digest, sizeof d[0].digest) != 0);
    assert_true(memcmp(d[0].digest, d[2].digest, sizeof d[0].digest) != 0);
    for (int i = 0; i < 3; i++)
        orl_parsed_scene_done(&d[i]);
}

/* ---- Jobs -------------------------------------------------------------------------------------
 */

#define ROOM                                                                                       \
    "void glow g 0 0 4 10 10 10 0\ng source s 0 0 4 0 0 1 180\n"                                   \
    "void plastic wall 0 0 5 .6 .6 .6 0 0\n"                                                       \
    "wall polygon a 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\nwall polygon b 0 0 12 4 0 0 4 0 3 4 4 3 4 4 "  \
    "0\n"                                                                                          \
    "wall polygon c 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3\nwall polygon d 0 0 12 0 0 3 0 4 3 4 4 3 4 0 "  \
    "3\n"
#define SPLIT                                                                                      \
    "void plastic white 0 0 5 .8 .7 .6 0 0\nvoid plastic black 0 0 5 .1 .1 .2 0 0\n"               \
    "black polygon e 0 0 12 0 0 0 2 0 0 2 4 0 0 4 0\n"                                             \
    "white polygon f 0 0 12 2 0 0 4 0 0 4 4 0 2 4 0\n"

enum { SENSORS = 4 };

static void run_scene(const char *scene, enum orl_technique technique, uint32_t threads,
                      double ret_lx[SENSORS])
{
    static const struct orl_sensor sensors[SENSORS] = {{{1, 2, .3}, {0, 0, -1}},
                                                       {{3, 2, .3}, {0, 0, -1}},
                                                       {{1, 3, 2.9}, {0, 0, -1}},
                                                       {{2, 3, 1}, {0, 0, -1}}};
    static const char pattern[] = "r = if(Px-2, .8, .1); g = if(Px-2, .7, .1);\n"
                                  "b = if(2-Px, .2, .6);";
    const struct scene_run job = {.scene = scene,
                                  .resource_name = "f.cal",
                                  .resource_text = pattern,
                                  .sensors = sensors,
                                  .n_sensors = SENSORS,
                                  .technique = technique,
                                  .overrides = scene_wish_maps,
                                  .global = 100000,
                                  .samples = 4096,
                                  .threads = threads};
    scene_run_lx(&job, ret_lx);
}

/*
 * A floor of two halves gives the same light in each form, by every technique: paths hit the same
 * colours. Two differences remain: photon searches do not cross the edge between polygons, and
 * some rays start elsewhere. 6 % are three standard errors of these few photons. Results are equal
 * to the byte for any number of threads.
 */
static void test_jobs(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                    ORL_TECHNIQUE_DIRECT,
                                                    ORL_TECHNIQUE_PRECOMPUTED};
    static const char patterned[] =
        ROOM "void colorfunc p 4 r g b f.cal 0 0\np plastic floor 0 0 5 1 1 1 0 0\n"
             "floor polygon f 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n";
    (void)state;
    for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++) {
        double split[SENSORS], one[SENSORS], two[SENSORS];
        run_scene(ROOM SPLIT, techniques[t], 1, split);
        run_scene(patterned, techniques[t], 1, one);
        run_scene(patterned, techniques[t], 2, two);
        assert_memory_equal(one, two, sizeof one);
        for (int i = 0; i < SENSORS; i++)
            if (!(fabs(one[i] / split[i] - 1) < .06))
                fail_msg("technique %zu, sensor %d: %g lx, and %g", t, i, one[i], split[i]);
    }
}

/* The mirror's pattern dims the sun's reflection, in each form of the pattern. */
static void test_patterned_mirrors(void **state)
{
#define SUN "void light l 0 0 3 1e5 1e5 1e5\nl source s 0 0 4 0 -1 1 .53\n"
#define SQUARE " polygon p 0 0 12 0 0 0 1 0 0 1 0 1 0 0 1\n"
    static const char *const scenes[] = {
        SUN "void mirror m 0 0 3 .9 .9 .9\nm" SQUARE,
        SUN "void brightfunc dim 2 .5 . 0 0\ndim mirror m 0 0 3 .9 .9 .9\nm" SQUARE,
        SUN "void mirror m 0 0 3 .9 .9 .9\nm brightfunc dim 2 .5 . 0 0\ndim" SQUARE,
        SUN "void brightfunc dim 2 if(Px-.4,.5,9) . 0 0\ndim mirror m 0 0 3 .9 .9 .9\nm" SQUARE,
    };
    static const struct orl_sensor sensor = {{0.5, -0.5, 0.2}, {0, 1, 0}};
    double lx[4];
    (void)state;
    for (size_t i = 0; i < 4; i++)
        scene_run_lx(&(struct scene_run){.scene = scenes[i],
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                         .samples = 256},
                     &lx[i]);
    assert_true(lx[0] > 500);
    for (size_t i = 1; i < 4; i++)
        if (!(fabs(lx[i] / lx[0] - 0.5) < 1e-6))
            fail_msg("scene %zu: %g lx of %g", i, lx[i], lx[0]);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),      cmocka_unit_test(test_cut),
        cmocka_unit_test(test_bounds),      cmocka_unit_test(test_endless),
        cmocka_unit_test(test_file_errors), cmocka_unit_test(test_keys),
        cmocka_unit_test(test_jobs),        cmocka_unit_test(test_patterned_mirrors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
