/*
 * Views: rays of the six types against values worked out by hand, the VIEW line's round trip,
 * errors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/job/run.h>

#include "render/film/film.h"

static struct orl_view parse(const char *text)
{
    struct orl_view view;
    struct orl_error err;
    if (orl_view_parse(text, &view, &err) < 0)
        fail_msg("%s: %s", text, err.message);
    return view;
}

/* Checks the ray's direction, of any length, and its origin. */
static void assert_ray(const struct orl_view *view, double x, double y, struct orl_vec3 origin,
                       struct orl_vec3 direction)
{
    struct orl_vec3 o, d;
    assert_true(orl_view_ray(view, x, y, &o, &d));
    assert_true(fabs(orl_length(d) - 1) < 1e-12);
    assert_true(orl_length(orl_sub(o, origin)) < 1e-9);
    assert_true(orl_length(orl_sub(d, orl_normalize(direction))) < 1e-9);
}

static const struct orl_vec3 zero = {0, 0, 0};

static void test_defaults(void **state)
{
    const struct orl_view v = parse("");
    (void)state;
    assert_int_equal(v.type, 'v');
    assert_true(v.horizontal == 45 && v.vertical == 45);
    assert_ray(&v, 0.5, 0.5, zero, orl_v3(0, 1, 0));
}

/* 90 degrees across: at the edges the tangent is 1; x is to the right of north, that is east. */
static void test_perspective(void **state)
{
    const struct orl_view v = parse("-vtv -vp 1 2 3 -vd 0 5 0 -vu 0 0 2 -vh 90 -vv 60");
    const double t = tan(30 * ORL_DEG_TO_RAD);
    const struct orl_vec3 at = {1, 2, 3};
    (void)state;
    assert_ray(&v, 0.5, 0.5, at, orl_v3(0, 1, 0));
    assert_ray(&v, 1, 1, at, orl_v3(1, 1, t));
    assert_ray(&v, 0, 0, at, orl_v3(-1, 1, -t));
    assert_ray(&v, 0.75, 0.25, at, orl_v3(0.5, 1, -0.5 * t));
    assert_true(fabs(orl_view_pixel_aspect(&v, 300, 200) - (t / 200) / (1.0 / 300)) < 1e-12);
}

/* The up vector is a hint: its component perpendicular to the direction is used. */
static void test_tilted_up(void **state)
{
    const struct orl_view v = parse("-vtv -vd 0 1 -1 -vu 0 0 1 -vh 90 -vv 90");
    const struct orl_vec3 d = orl_normalize(orl_v3(0, 1, -1)), up = orl_normalize(orl_v3(0, 1, 1));
    (void)state;
    assert_ray(&v, 1, 1, zero, orl_add(orl_add(d, up), orl_v3(1, 0, 0)));
}

/* Parallel: the size is in scene units; origins differ and directions do not. */
static void test_parallel(void **state)
{
    const struct orl_view v = parse("-vtl -vp 0 0 10 -vd 0 0 -1 -vu 0 1 0 -vh 4 -vv 2");
    (void)state;
    assert_ray(&v, 0.5, 0.5, orl_v3(0, 0, 10), orl_v3(0, 0, -1));
    assert_ray(&v, 1, 1, orl_v3(2, 1, 10), orl_v3(0, 0, -1));
    assert_ray(&v, 0, 1, orl_v3(-2, 1, 10), orl_v3(0, 0, -1));
    assert_true(fabs(orl_view_pixel_aspect(&v, 40, 20) - 1) < 1e-12);
}

/* Angular fisheye of 180 degrees: the angle from the axis is proportional to the radius; corners
 * have no rays. */
static void test_angular_fisheye(void **state)
{
    const struct orl_view v = parse("-vta -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180");
    const double a = 45 * ORL_DEG_TO_RAD, b = 90 * sqrt(0.5) * ORL_DEG_TO_RAD;
    struct orl_vec3 o, d;
    (void)state;
    assert_ray(&v, 0.5, 0.5, zero, orl_v3(0, 1, 0));
    assert_ray(&v, 0.75, 0.5, zero, orl_v3(sin(a), cos(a), 0));
    assert_ray(&v, 0.5, 0.25, zero, orl_v3(0, cos(a), -sin(a)));
    assert_ray(&v, 1, 0.5, zero, orl_v3(1, 0, 0));
    /* Along the diagonal: 64 degrees off at (3/4, 3/4). */
    assert_ray(&v, 0.75, 0.75, zero, orl_v3(sin(b) * sqrt(0.5), cos(b), sin(b) * sqrt(0.5)));
    /* Radiance's limit is 360 degrees: the square's corners are at 127 degrees here. */
    assert_true(orl_view_ray(&v, 1, 1, &o, &d));
    const struct orl_view all = parse("-vta -vd 0 1 0 -vu 0 0 1 -vh 360 -vv 360");
    assert_ray(&all, 1, 0.5, zero, orl_v3(0, -1, 0));
    assert_false(orl_view_ray(&all, 1, 1, &o, &d));
}

/* Hemispherical fisheye: the sine of the angle is proportional to the radius; there are no rays
 * beyond the circle. */
static void test_hemispherical_fisheye(void **state)
{
    const struct orl_view v = parse("-vth -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180");
    struct orl_vec3 o, d;
    (void)state;
    assert_ray(&v, 0.75, 0.5, zero, orl_v3(0.5, sqrt(0.75), 0));
    assert_ray(&v, 0.5, 0.9, zero, orl_v3(0, 0.6, 0.8));
    assert_false(orl_view_ray(&v, 1, 1, &o, &d));
}

/*
 * Shift and lift move the image by its own size; -vo starts rays further away: at a plane in
 * perspective, at a sphere in a fisheye.
 */
static void test_shift_and_clip(void **state)
{
    const struct orl_view v = parse("-vtv -vd 0 1 0 -vu 0 0 1 -vh 90 -vv 90 -vs .5 -vl -.5 -vo 2");
    const struct orl_view a = parse("-vta -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180 -vo 2");
    (void)state;
    assert_ray(&v, 0.5, 0.5, orl_v3(2, 2, -2), orl_v3(1, 1, -1));
    assert_ray(&a, 1, 0.5, orl_v3(2, 0, 0), orl_v3(1, 0, 0));
}

static void assert_same(const struct orl_view *a, const struct orl_view *b)
{
    struct orl_vec3 oa, da, ob, db;
    for (int i = 0; i < 9; i++) {
        const double x = i % 3 / 2.0, y = i / 3 / 2.0;
        const bool seen = orl_view_ray(a, x, y, &oa, &da);
        assert_int_equal(seen, orl_view_ray(b, x, y, &ob, &db));
        if (!seen)
            continue;
        /* Nine digits are written. */
        assert_true(orl_length(orl_sub(oa, ob)) < 1e-6 && orl_length(orl_sub(da, db)) < 1e-7);
    }
}

static void test_round_trip(void **state)
{
    static const char *const texts[] = {
        "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60",
        "-vtl -vp 1 2 3 -vd 1 1 -1 -vu 0 0 1 -vh 12.5 -vv 8 -vs 0.25 -vl -0.125",
        "-vta -vp 1.3 2 1.2 -vd 1 0 0 -vu 0 0 1 -vh 180 -vv 170",
        "-vth -vp -1e3 2e-3 1 -vd 1 2 3 -vu 1 0 0 -vh 120 -vv 100 -vo .1 -va 20"};
    (void)state;
    for (int i = 0; i < 4; i++) {
        const struct orl_view first = parse(texts[i]);
        char text[1024];
        orl_view_format(&first, text, sizeof text);
        const struct orl_view second = parse(text);
        assert_int_equal(first.type, second.type);
        assert_same(&first, &second);
        /* Every parameter is written, because evalglare accepts nothing less. */
        for (const char *option = "pduhvoasl"; *option; option++) {
            const char word[] = {' ', '-', 'v', *option, ' ', '\0'};
            assert_non_null(strstr(text, word));
        }
    }
}

/* The form in files: with a keyword in front, and blanks anywhere. */
static void test_prefixes(void **state)
{
    static const char *const prefixes[] = {"VIEW= ", "VIEW=",      "rpict ", "rvu ",
                                           "rview ", "VIEW= rvu ", "  \t",   ""};
    const struct orl_view plain = parse("-vta -vp 1 2 3 -vd 1 0 0 -vh 100 -vv 100");
    (void)state;
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
        char text[128] = "";
        strcat(text, prefixes[i]);
        strcat(text, "-vta  -vp 1 2 3\t-vd 1 0 0\n-vh 100 -vv 100 ");
        const struct orl_view v = parse(text);
        assert_same(&v, &plain);
    }
}

/* Stereographic: half way to the edge of 180 degrees the angle is 2 atan(1/2), at the edge 90. */
static void test_planispheric_fisheye(void **state)
{
    const struct orl_view v = parse("-vts -vd 0 1 0 -vh 180 -vv 180");
    const double half = 2 * atan(0.5);
    (void)state;
    assert_ray(&v, 0.5, 0.5, zero, orl_v3(0, 1, 0));
    assert_ray(&v, 1, 0.5, zero, orl_v3(1, 0, 0));
    assert_ray(&v, 0.5, 0.25, zero, orl_v3(0, cos(half), -sin(half)));
    assert_ray(&v, 0.75, 0.5, zero, orl_v3(sin(half), cos(half), 0));
    /* The corners have rays too: behind the eye. */
    assert_ray(&v, 1, 1, zero, orl_v3(2, -1, 2));
    assert_true(fabs(orl_view_pixel_aspect(&v, 10, 10) - 1) < 1e-12);
}

/* Cylindrical: azimuth is linear, height by the tangent; clipped by cylinders. */
static void test_cylindrical(void **state)
{
    const struct orl_view v = parse("-vtc -vd 0 1 0 -vh 360 -vv 90 -vo 2 -va 5");
    (void)state;
    assert_ray(&v, 0.5, 0.5, orl_v3(0, 2, 0), orl_v3(0, 1, 0));
    assert_ray(&v, 0.75, 0.5, orl_v3(2, 0, 0), orl_v3(1, 0, 0));
    assert_ray(&v, 0.75, 1, orl_v3(2, 0, 2), orl_v3(1, 0, 1));
    assert_ray(&v, 0.25, 0, orl_v3(-2, 0, -2), orl_v3(-1, 0, -1));
    assert_true(fabs(orl_view_clip_distance(&v, 0.75, 0.5) - 3) < 1e-12);
    assert_true(fabs(orl_view_clip_distance(&v, 0.75, 1) - 3 * sqrt(2)) < 1e-12);
    assert_true(fabs(orl_view_pixel_aspect(&v, 100, 100) - 1 / ORL_PI) < 1e-12);
}

/* -va ends rays at a plane in perspective, at a sphere in fisheyes. */
static void test_reachability(void **state)
{
    const struct orl_view v = parse("-vtv -vh 90 -vv 90 -vo 1 -va 4");
    const struct orl_view a = parse("-vta -vh 180 -vv 180 -va 4");
    const struct orl_view open = parse("-vtv");
    (void)state;
    assert_true(fabs(orl_view_clip_distance(&v, 0.5, 0.5) - 3) < 1e-12);
    assert_true(fabs(orl_view_clip_distance(&v, 1, 1) - 3 * sqrt(3)) < 1e-12);
    assert_true(orl_view_clip_distance(&a, 0.9, 0.5) == 4);
    assert_true(isinf(orl_view_clip_distance(&open, 0.5, 0.5)));
}

/* Sizes as in rpict: one side is reduced to keep the aspect. */
static void test_sizes(void **state)
{
    const struct orl_view v = parse("-vtv -vh 90 -vv 53.1301 -x 800 -y 800 -pa 1");
    uint32_t width = v.x, height = v.y;
    (void)state;
    assert_true(v.x == 800 && v.y == 800 && v.pixel_aspect == 1);
    orl_view_fit(&v, 1, &width, &height);
    assert_true(width == 800 && height == 400);
    height = 100;
    orl_view_fit(&v, 1, &width, &height);
    assert_true(width == 200 && height == 100);
    width = height = 800;
    orl_view_fit(&v, 2, &width, &height);
    assert_true(width == 800 && height == 200);
    width = height = 800;
    orl_view_fit(&v, 0, &width, &height);
    assert_true(width == 800 && height == 800);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static const char lines[] = "#?RADIANCE\n"
                            "rvu -vtv -vp 1 2 3 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 45 -vs 0 -vl 0\n"
                            "\tview= desk -vta -vh 180 -vv 180\n"
                            "ZONE= I 0 1 0 1 0 1\n"
                            "VIEW= -vtl -vh 3 -vv 2\n";

static void expect_view(const char *entry, char type, double horizontal)
{
    char *text = NULL;
    struct orl_error err = {0};
    if (orl_view_file_read("a.vf", lines, sizeof lines - 1, entry, &text, &err) < 0)
        fail_msg("%s: %s", entry, err.message);
    const struct orl_view v = parse(text);
    assert_true(v.type == type && v.horizontal == horizontal);
    free(text);
}

static void expect_no_view(const char *text, const char *entry, int code, int line)
{
    char *found = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_view_file_read("a.vf", text, strlen(text), entry, &found, &err), code);
    assert_null(found);
    assert_string_equal(err.file, "a.vf");
    assert_int_equal(err.line, line);
}

static void test_files(void **state)
{
    (void)state;
    expect_view("1", 'v', 60);
    expect_view("desk", 'a', 180);
    expect_view("2", 'a', 180);
    expect_view("3", 'l', 3);
    expect_no_view(lines, "4", ORL_ERR_NOT_FOUND, 0);
    expect_no_view(lines, NULL, ORL_ERR_INVALID, 0);
    expect_no_view("nothing\n", NULL, ORL_ERR_NOT_FOUND, 0);
    expect_no_view("\n\nrvu -vp 1 2 x\n", NULL, ORL_ERR_SYNTAX, 3);
}

/* Options after a file's replace the same options; the others stay. */
static void test_options_behind_a_file(void **state)
{
    (void)state;
    char *whole = orl_view_text_join("-vtv -vp 1 2 3 -vd 0 1 0 -vh 60 -vv 45", "-vta -vh 180");
    assert_non_null(whole);
    const struct orl_view v = parse(whole);
    assert_true(v.type == 'a' && v.horizontal == 180 && v.vertical == 45 && v.point.y == 2);
    free(whole);
    whole = orl_view_text_join("-vtl", NULL);
    assert_string_equal(whole, "-vtl");
    free(whole);
}

static void test_errors(void **state)
{
    static const struct {
        const char *text;
        int code;
    } bad[] = {{"-vtv -vp 1 2", ORL_ERR_SYNTAX},
               {"-vtv -vp 1 2 x", ORL_ERR_SYNTAX},
               {"-vtv -vp 1 2 nan", ORL_ERR_SYNTAX},
               {"-vtv -vp 1 2 1e999", ORL_ERR_SYNTAX},
               {"-vtx", ORL_ERR_SYNTAX},
               {"-vt", ORL_ERR_SYNTAX},
               {"-vtvv", ORL_ERR_SYNTAX},
               {"-vts -vh 360", ORL_ERR_RANGE},
               {"-vtc -vh 360 -vv 180", ORL_ERR_RANGE},
               {"-x 0", ORL_ERR_RANGE},
               {"-y 1.5", ORL_ERR_RANGE},
               {"-pa", ORL_ERR_SYNTAX},
               {"-foo 3", ORL_ERR_SYNTAX},
               {"view.vf", ORL_ERR_SYNTAX},
               {"-vd 0 0 0", ORL_ERR_RANGE},
               {"-vd 0 0 1 -vu 0 0 1", ORL_ERR_RANGE},
               {"-vd 0 0 1 -vu 0 0 -3", ORL_ERR_RANGE},
               {"-vu 0 0 0", ORL_ERR_RANGE},
               {"-vh 0", ORL_ERR_RANGE},
               {"-vv -20", ORL_ERR_RANGE},
               {"-vtv -vh 180", ORL_ERR_RANGE},
               {"-vth -vh 181", ORL_ERR_RANGE},
               {"-vta -vh 361", ORL_ERR_RANGE},
               {"-vo -1", ORL_ERR_RANGE},
               {"-vo 3 -va 2", ORL_ERR_RANGE}};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct orl_view view = {.type = '?'};
        struct orl_error err = {0};
        const int code = orl_view_parse(bad[i].text, &view, &err);
        if (code != bad[i].code)
            fail_msg("'%s' gave %d", bad[i].text, code);
        assert_int_equal(err.code, code);
        assert_true(err.message[0] != '\0');
        assert_int_equal(view.type, '?'); /* unchanged on failure */
        assert_int_equal(orl_view_parse(bad[i].text, &view, NULL), bad[i].code);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_perspective),
        cmocka_unit_test(test_tilted_up),
        cmocka_unit_test(test_parallel),
        cmocka_unit_test(test_angular_fisheye),
        cmocka_unit_test(test_hemispherical_fisheye),
        cmocka_unit_test(test_shift_and_clip),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_planispheric_fisheye),
        cmocka_unit_test(test_cylindrical),
        cmocka_unit_test(test_reachability),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_options_behind_a_file),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_prefixes),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
