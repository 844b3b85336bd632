/*
 * Textures: their normals, against closed forms; nothing is sent below the surface or gained;
 * radiance of a matt one under a sun and in a white furnace, by two techniques.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/built/scene.h"
#include "scene/material/patterns/texture.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/scratch.h"

#define FLOOR "m polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"

static struct orl_scene *load(const char *text, const char *name, const char *resource)
{
    struct orl_parsed_scene parsed_scene = scene_parse_text(text, name, resource);
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    if (orl_scene_new(&parsed_scene, &scene, &err) < 0)
        fail_msg("%s", err.message);
    return scene;
}

/* Finds the material where a ray hits that place of the floor, from above or below; `from` is set
 * to the direction the ray comes from. */
static const struct orl_material *intersect_floor(const struct orl_scene *scene, double x, double y,
                                                  struct orl_vec3 from, struct orl_hit *ret_hit)
{
    const struct orl_vec3 there = orl_sub(orl_v3(x, y, 0), scene->geometry->center);
    assert_true(orl_geometry_intersect(scene->geometry, orl_madd(there, from, 5), orl_neg(from),
                                       100, ret_hit));
    return orl_scene_material(scene, ret_hit->facet);
}

static void expect_normal(const struct orl_scene *scene, double x, double y, struct orl_vec3 from,
                          struct orl_vec3 turn)
{
    struct orl_hit hit;
    const struct orl_vec3 eye = orl_normalize(from);
    const struct orl_material *const m = intersect_floor(scene, x, y, eye, &hit);
    const struct orl_vec3 up = orl_normalize(orl_add(orl_v3(0, 0, 1), turn));
    const struct orl_vec3 wanted = eye.z > 0 ? up : orl_neg(up);
    const struct orl_vec3 normal = orl_normal_at(m, &hit, eye);
    if (!(orl_length(orl_sub(normal, wanted)) < 1e-5)) /* hits are computed from floats */
        fail_msg("%g %g %g, not %g %g %g", normal.x, normal.y, normal.z, wanted.x, wanted.y,
                 wanted.z);
}

/* Textures are evaluated in the function's frame, whose scale is irrelevant; several add up, also
 * with a pattern between. */
static void test_normals(void **state)
{
    static const struct orl_vec3 above = {.1, .2, 1}, below = {.1, 0, -1};
    (void)state;
    struct orl_scene *scene = load("void texfunc t 4 dx dy 0 f.cal 0 2 .1 .2\n"
                                   "t plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                                   "f.cal", "dx = A1*Px; dy = A2*Py*Nz;");
    expect_normal(scene, 1, 2, above, orl_v3(.1, .4, 0));
    expect_normal(scene, 2, 1, below, orl_v3(.2, .2, 0)); /* the front's, reversed */
    orl_scene_release(scene);
    scene = load("void texfunc t 8 .1*Px 0 .2 . -s 2 -rz 90 0 0\n"
                 "t brightfunc b 2 .5 . 0 0\nb texfunc u 4 0 .3 0 . 0 0\n"
                 "u metal m 0 0 5 .5 .5 .5 .9 .1\n" FLOOR,
                 NULL, NULL);
    /* The function's x is the world's y, its y the negative x. */
    expect_normal(scene, 1, 2, above, orl_v3(0, .1 + .3, .2));
    struct orl_hit hit;
    assert_true(
        fabs(orl_material_diffuse(intersect_floor(scene, 1, 1, orl_v3(0, 0, 1), &hit), &hit).r -
             .5 * .5 * .1) < 1e-9);
    orl_scene_release(scene);
}

/* Textures by values on a grid: functions combine the values of all three files. */
static void test_data(void **state)
{
    static const char *const names[] = {"a.rad", "f.cal", "x.dat", "y.dat"};
    static const char *const texts[] = {"void texdata t 9 f g h x.dat y.dat x.dat f.cal Px Py 0 0\n"
                                        "t plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                                        "f(a,b,c) = a; g(a,b,c) = a + b; h(a) = 0*a;",
                                        "2\n0 4 2\n0 4 2\n0 0 .4 .4\n",
                                        "2\n0 4 2\n0 4 2\n0 .8 0 .8\n"};
    struct orl_file files[4];
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    (void)state;
    for (int i = 0; i < 4; i++)
        files[i] = (struct orl_file){texts[i], strlen(texts[i]), NULL};
    struct orl_memory_files memory = {names, files, 4};
    const struct orl_files provider = orl_files_from_memory(&memory);
    if (orl_scene_parse(names, 1, &provider, &d, &err) < 0 || orl_scene_new(&d, &scene, &err) < 0)
        fail_msg("%s", err.message);
    expect_normal(scene, 1, 3, orl_v3(0, 0, 1), orl_v3(.1, .1 + .6, 0));
    orl_scene_release(scene);
}

/* Normals as gensurf -s and obj2rad write them, with the meaning of Radiance's library files. */
static void test_library(void **state)
{
    (void)state;
    struct orl_scene *scene = load("void texfunc t 4 surf_dx surf_dy surf_dz surf.cal 0\n"
                                   "13 2 .1 0 0 0 .2 0 0 0 .3 .4 0 0\n"
                                   "t plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                                   NULL, NULL);
    expect_normal(scene, 2, 3, orl_v3(0, 0, 1), orl_v3(.1 * 6 + .4, .2 * 2, .3 * 3));
    orl_scene_release(scene);
    scene = load("void texfunc t 4 dx dy dz tmesh.cal 0\n10 2 .1 0 0 0 .2 0 0 0 1\n"
                 "t plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                 NULL, NULL);
    const struct orl_vec3 wanted = orl_normalize(orl_v3(.2, .6, 1));
    expect_normal(scene, 2, 3, orl_v3(0, 0, 1), orl_sub(wanted, orl_v3(0, 0, 1)));
    orl_scene_release(scene);
}

/* A material's texture and pattern, placed between it and surfaces as by obj2rad; repeating them
 * changes nothing. */
static void test_over_material(void **state)
{
    static const char text[] = "void texfunc w 4 .1 0 0 . 0 0\n"
                               "w plastic red 0 0 5 .8 .4 .2 0 0\n"
                               "red texfunc n 4 .2*Px 0 0 . 0 0\nn brightfunc m 2 .5 . 0 0\n" FLOOR
                               "red texfunc n 4 .2*Px 0 0 . 0 0\nn brightfunc m 2 .5 . 0 0\n"
                               "m sphere ball 0 0 4 0 0 -9 1\n";
    struct orl_scene *const scene = load(text, NULL, NULL);
    struct orl_hit hit;
    (void)state;
    assert_int_equal(scene->parsed_scene.n_materials, 3);
    expect_normal(scene, 2, 1, orl_v3(0, .1, 1), orl_v3(.1 + .4, 0, 0));
    const struct orl_rgb seen =
        orl_material_diffuse(intersect_floor(scene, 1, 1, orl_v3(0, 0, 1), &hit), &hit);
    assert_true(fabs(seen.r - .4) < 1e-9 && fabs(seen.b - .1) < 1e-9);
    orl_scene_release(scene);
}

/* From all directions, for any tilt of the normal: the side is kept, and at most the reflected
 * share is sent on. */
static void test_sides(void **state)
{
    static const char *const materials[] = {
        "t metal m 0 0 5 .9 .9 .9 1 0\n", "t metal m 0 0 5 .9 .9 .9 1 .2\n",
        "t mirror m 0 0 3 .9 .9 .9\n", "t glass m 0 0 3 .9 .9 .9\n",
        "t dielectric m 0 0 5 .9 .9 .9 1.5 0\n"};
    (void)state;
    for (size_t k = 0; k < sizeof materials / sizeof *materials; k++) {
        char text[512];
        snprintf(text, sizeof text, "void texfunc t 4 1.5*sin(9*Px) cos(7*Py) -.3 . 0 0\n%s%s",
                 materials[k], FLOOR);
        struct orl_scene *const scene = load(text, NULL, NULL);
        struct orl_random random = orl_random_stream(7, 0, k);
        for (int i = 0; i < 4000; i++) {
            const double u = 2 * orl_random_uniform(&random) - 1, s = sqrt(1 - u * u);
            const double phi = 6.2831853 * orl_random_uniform(&random);
            const struct orl_vec3 from = orl_v3(s * cos(phi), s * sin(phi), u);
            struct orl_hit hit;
            const struct orl_material *const m =
                intersect_floor(scene, 4 * orl_random_uniform(&random),
                                4 * orl_random_uniform(&random), from, &hit);
            const struct orl_vec3 normal = orl_normal_at(m, &hit, from);
            assert_true(orl_dot(normal, from) >= 0 && fabs(orl_length(normal) - 1) < 1e-9);
            const struct orl_surface_sample sent =
                orl_material_sample(m, &hit, from, i & 1 ? ORL_TRANSPORT_LIGHT : ORL_TRANSPORT_EYE,
                                    ORL_LOBE_ALL, &random);
            if (sent.event == ORL_EVENT_ABSORBED)
                continue;
            assert_true((orl_dot(sent.direction, hit.normal) * orl_dot(from, hit.normal) < 0) ==
                        sent.transmitted);
            if (m->kind == ORL_MATERIAL_METAL && !(orl_reflector_of(m)->roughness[0] > 0))
                assert_true(sent.weight.r <= .9 + 1e-9);
        }
        orl_scene_release(scene);
    }
}

/* Returns the mean radiance of a view from above onto the floor's middle. */
static double seen(const char *text, enum orl_technique technique)
{
    enum { SIDE = 8 };
    double rgb[SIDE * SIDE][3], sum = 0;
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = text,
                                      .view = "-vtl -vp 2 2 3 -vd 0 0 -1 -vu 0 1 0 -vh .4 -vv .4",
                                      .width = SIDE,
                                      .height = SIDE,
                                      .technique = technique,
                                      .pixel_samples = 64,
                                      .folder = scratch_path("")});
    hdr_read(scratch_path("view.hdr"), SIDE, SIDE, rgb);
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += rgb[i][1] / (SIDE * SIDE);
    orl_result_done(&result);
    return sum;
}

/* Under a sun the radiance follows the cosine to the tilted normal. In an even sky all round,
 * which the floor hides below the surface, all light is received for any tilt of the normal.
 * Tolerances: 0.4 % for the picture's digits, and 1 % more where 64 paths a pixel, or a record's
 * rays, sum up the sky. */
static void test_seen(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    static const char sunny[] = "void texfunc t 4 .5 0 0 . 0 0\nt plastic m 0 0 5 .5 .5 .5 0 0\n"
                                "void light l 0 0 3 1e6 1e6 1e6\nl source s 0 0 4 3 0 4 .2\n" FLOOR;
    static const char even[] = "void texfunc t 4 .5 0 0 . 0 0\nt plastic m 0 0 5 .5 .5 .5 0 0\n"
                               "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 360\n" FLOOR;
    const double half = .1 * 3.14159265358979 / 180, disc = 3.14159265358979 * pow(sin(half), 2);
    const double cosine = (.5 * .6 + .8) / sqrt(1.25);
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        const double sun =
            seen(sunny, techniques[i]) / (.5 / 3.14159265358979 * 1e6 * disc * cosine);
        const double sky = seen(even, techniques[i]) / .5;
        if (!(fabs(sun - 1) < .004) || !(fabs(sky - 1) < .014))
            fail_msg("technique %zu: of the sun %g, of the sky %g of what is due", i, sun, sky);
    }
}

/* Smooth balls by gensurf and rods by genrev: away from corners, normals agree with the exact
 * shape much better than those of the flat polygons. */
static void test_generated(void **state)
{
    const double height = 1.37, x = .41, y = .23;
    struct orl_hit hit;
    (void)state;
    struct orl_scene *scene = load(
        "void plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR
        "!gensurf m ball 'sin(PI*s)*cos(2*PI*t)' 'sin(PI*s)*sin(2*PI*t)' 'cos(PI*s)' 30 60 -s\n",
        NULL, NULL);
    const struct orl_material *m = intersect_floor(scene, x, y, orl_v3(0, 0, 1), &hit);
    const struct orl_vec3 round = orl_v3(x, y, sqrt(1 - x * x - y * y));
    assert_true(orl_length(orl_sub(orl_normal_at(m, &hit, orl_v3(0, 0, 1)), round)) < 2e-3);
    assert_true(orl_length(orl_sub(hit.normal, round)) > 1e-2);
    orl_scene_release(scene);
    scene = load("void plastic m 0 0 5 .5 .5 .5 0 0\n" FLOOR
                 "!genrev m bowl t 'sqrt(2*t+.01)' 100 -s | xform -t 0 0 1\n",
                 NULL, NULL);
    const struct orl_vec3 from = orl_v3(9, .3, height);
    const struct orl_vec3 origin = orl_sub(from, scene->geometry->center);
    assert_true(orl_geometry_intersect(scene->geometry, origin, orl_v3(-1, 0, 0), 100, &hit));
    m = orl_scene_material(scene, hit.facet);
    /* r^2 = 2 z + .01 has its normal along (x, y, -1). */
    const double out = sqrt(2 * (height - 1) + .01 - .09);
    const struct orl_vec3 bowl = orl_normalize(orl_v3(out, .3, -1));
    assert_true(orl_length(orl_sub(orl_normal_at(m, &hit, orl_v3(1, 0, 0)), bowl)) < 2e-3);
    orl_scene_release(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_data),
        cmocka_unit_test(test_sides),
        cmocka_unit_test(test_over_material),
        cmocka_unit_test(test_library),
        cmocka_unit_test(test_generated),
        cmocka_unit_test_setup_teardown(test_seen, scratch_set_up, scratch_tear_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
