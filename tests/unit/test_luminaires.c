/*
 * IES files as luminaires, by ies2rad and directly. Far away each gives the intensity that it was
 * measured with, for any shape. An error in a file names its line.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"
#include "support/scene_text.h"

#define DOWN "0 30 60 90\n"
#define ROUND "0 30 60 120 150 180\n"
/* Candelas by vertical angle: for one horizontal angle, three in a quadrant, one of a full circle.
 */
#define ONE "300 200 100 0\n"
#define THREE "300 200 100 0\n300 150 50 0\n300 120 30 0\n"
#define ALL "50 100 150 120 80 40\n"

struct file {
    const char *text;
    double vertical, horizontal, candela; /* direction, in degrees, and expected intensity there */
};

static const struct file files[] = {
    /* flat, by quadrants; also halfway between two horizontal angles */
    {"IESNA:LM-63-1995\n[TEST] one\nTILT=NONE\n1 1000 2 4 3 1 2 .3 .6 0\n1 1 40\n" DOWN
     "0 45 90\n" THREE,
     30, 45, 300},
    {"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 4 3 1 2 .3 .6 0\n1 1 40\n" DOWN "0 45 90\n" THREE, 60,
     112.5, 40},
    /* a disc in feet, with multipliers of the 1991 format */
    {"IESNA91\r\nTILT=NONE\r\n1 1000 1 4 1 1 1 -1 0 0\r\n.9 .5 40\r\n" DOWN "0\r\n" ONE, 30, 200,
     90},
    /* a box, a cylinder, a ball and a point, which also emit upwards */
    {"IESNA:LM-63-2002\nTILT=NONE\n1,1000,1,6,1,1,2,.3,.6,.2\n1,1,40\n" ROUND "0\n" ALL, 60, 20,
     150},
    {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 6 1 1 2 -.2 0 .3\n1 1 40\n" ROUND "0\n" ALL, 120, 300,
     120},
    {"IES:LM-63-2019\nTILT=NONE\n1 1000 1 6 1 1 2 -.2 -.2 -.2\n1 1 40\n" ROUND "0\n" ALL, 150, 0,
     80},
    {"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 6 1 1 2 0 0 0\n1 1 40\n" ROUND "0\n" ALL, 30, 0, 100},
};

/* 60 m away openings act as points: a face half a metre nearer makes a hundredth at most. */
static void test_far_away(void **state)
{
    static const char *const scenes[] = {"!ies2rad -s lamp.ies\n", "!xform -t 0 0 0 lamp.ies\n",
                                         "!ies2rad -m 3 -dm lamp.ies\n"};
    const double d = 60;
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        for (size_t k = 0; k < 3; k++) {
            const double down = files[i].vertical * ORL_DEG_TO_RAD;
            const double around = files[i].horizontal * ORL_DEG_TO_RAD;
            const struct orl_vec3 way = {sin(down) * cos(around), sin(down) * sin(around),
                                         -cos(down)};
            const struct orl_sensor sensor = {orl_scale(way, d), orl_neg(way)};
            const double wanted = files[i].candela / (d * d) * (k == 2 ? 3 : 1);
            double lx;
            scene_run_lx(&(struct scene_run){.scene = scenes[k],
                                             .resource_name = "lamp.ies",
                                             .resource_text = files[i].text,
                                             .sensors = &sensor,
                                             .n_sensors = 1,
                                             .technique = ORL_TECHNIQUE_BACKWARD,
                                             .samples = 1024},
                         &lx);
            if (!(fabs(lx / wanted - 1) < .01))
                fail_msg("file %zu, scene %zu: %g lx, not %g", i, k, lx, wanted);
        }
}

/* A file is an IES file for any number of lines before TILT=. */
static void test_long_head(void **state)
{
    enum { LINES = 1500 };
    static const char begin[] = "IESNA:LM-63-2002\n", line[] = "[MORE] x\n";
    static char text[sizeof begin + LINES * sizeof line + 256];
    const struct orl_sensor sensor = {{0, 0, -60}, {0, 0, 1}};
    double lx;
    (void)state;
    size_t length = (size_t)snprintf(text, sizeof text, "%s", begin);
    for (int i = 0; i < LINES; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s", line);
    snprintf(text + length, sizeof text - length,
             "TILT=NONE\n1 1000 1 6 1 1 2 0 0 0\n1 1 40\n" ROUND "0\n" ALL);
    scene_run_lx(&(struct scene_run){.scene = "!ies2rad -s lamp.ies\n",
                                     .resource_name = "lamp.ies",
                                     .resource_text = text,
                                     .sensors = &sensor,
                                     .n_sensors = 1,
                                     .technique = ORL_TECHNIQUE_BACKWARD,
                                     .samples = 64},
                 &lx);
    assert_true(fabs(lx / (50.0 / (60 * 60)) - 1) < .01);
}

/* Beyond its vertical angles a luminaire of any shape gives no light; angles outside LM-63 give a
 * warning. */
static void test_beyond_the_angles(void **state)
{
    static const struct {
        const char *text;
        double lit, dark; /* degrees from straight down */
        const char *warning;
    } cases[] = {
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 40\n0 20 45\n0\n9 9 9\n", 44, 60,
         "its vertical angles are from 0 to 45 degrees: it emits no light beyond these"},
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 .2 .2 0\n1 1 40\n0 20 45\n0\n9 9 9\n", 44,
         46, "its vertical angles are from 0 to 45 degrees: it emits no light beyond these"},
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 40\n30 60 90\n0\n9 9 9\n", 31,
         29, "its vertical angles are from 30 to 90 degrees: it emits no light beyond these"},
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 40\n0 45 90\n0\n9 9 9\n", 80,
         180, NULL},
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 40\n90 135 180\n0\n9 9 9\n", 100,
         0, NULL},
        {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 3 2 2 0 0 0\n1 1 40\n-45 0 45\n-45 0 45\n"
         "9 9 9\n9 9 9\n9 9 9\n",
         44, 46, "its vertical angles are from -45 to 45 degrees: it emits no light beyond these"},
    };
    const double d = 60;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_sensor sensors[2];
        for (int k = 0; k < 2; k++) {
            const double down = (k == 0 ? cases[i].lit : cases[i].dark) * ORL_DEG_TO_RAD;
            const struct orl_vec3 way = {sin(down), 0, -cos(down)};
            sensors[k] = (struct orl_sensor){orl_scale(way, d), orl_neg(way)};
        }
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = "!ies2rad lamp.ies\n",
                                          .resource_name = "lamp.ies",
                                          .resource_text = cases[i].text,
                                          .sensors = sensors,
                                          .n_sensors = 2,
                                          .technique = ORL_TECHNIQUE_BACKWARD,
                                          .samples = 1024});
        const double lit = result.illuminance_lx[0], dark = result.illuminance_lx[1];
        bool told = false;
        for (size_t k = 0; k < result.n_warnings; k++)
            told |= strstr(result.warnings[k],
                           cases[i].warning ? cases[i].warning : "vertical angles") != NULL;
        if (!(fabs(lit * d * d / 9 - 1) < .01) || dark != 0 || told != (cases[i].warning != NULL))
            fail_msg("case %zu: %g and %g cd, %s", i, lit * d * d, dark * d * d,
                     told ? "with the warning" : "without a warning");
        orl_result_done(&result);
    }
}

/* Planes missing at the end: the last one continues, or the first after a full circle; in type B
 * it is dark there. */
static void test_missing_planes(void **state)
{
#define HEAD(TYPE, PLANES)                                                                         \
    "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 3 " PLANES " " TYPE " 2 0 0 0\n1 1 40\n"
    static const struct {
        const char *text;
        double horizontal, candela; /* 30 degrees from straight down */
        const char *warning;
    } cases[] = {
        {HEAD("1", "3") "0 30 90\n0 20 45\n9 9 9\n8 8 8\n4 4 4\n", 90, 4,
         "its horizontal angles are from 0 to 45 degrees: beyond these it emits as at the "
         "last angle"},
        {HEAD("1", "4") "0 30 90\n0 90 180 270\n9 9 9\n8 8 8\n7 7 7\n3 3 3\n", 315, 6,
         "its horizontal angles are from 0 to 270 degrees: beyond these it is interpolated towards "
         "the first angle"},
        {HEAD("1", "3") "0 30 90\n0 45 90\n9 9 9\n8 8 8\n4 4 4\n", 90, 4, NULL},
    };
    const double d = 60, down = 30 * ORL_DEG_TO_RAD;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double around = cases[i].horizontal * ORL_DEG_TO_RAD;
        const struct orl_vec3 way = {sin(down) * cos(around), sin(down) * sin(around), -cos(down)};
        const struct orl_sensor sensor = {orl_scale(way, d), orl_neg(way)};
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = "!ies2rad lamp.ies\n",
                                          .resource_name = "lamp.ies",
                                          .resource_text = cases[i].text,
                                          .sensors = &sensor,
                                          .n_sensors = 1,
                                          .technique = ORL_TECHNIQUE_BACKWARD,
                                          .samples = 1024});
        const double candela = result.illuminance_lx[0] * d * d;
        bool told = false;
        for (size_t k = 0; k < result.n_warnings; k++)
            told |= strstr(result.warnings[k],
                           cases[i].warning ? cases[i].warning : "horizontal angles") != NULL;
        if (!(fabs(candela / cases[i].candela - 1) < .01) || told != (cases[i].warning != NULL))
            fail_msg("case %zu: %g cd, %s", i, candela, told ? "warned of" : "no warning");
        orl_result_done(&result);
    }
}

/* In millimetres, at 60 000 of them. The colour is the lamp's. */
static void test_units_and_colors(void **state)
{
    const struct orl_sensor sensor = {{0, 0, -60000}, {0, 0, 1}};
    double lx;
    (void)state;
    scene_run_lx(
        &(struct scene_run){.scene = "!ies2rad -dm/1000 -c 2 2 2 -o x -t default lamp.ies\n",
                            .resource_name = "lamp.ies",
                            .resource_text = files[0].text,
                            .sensors = &sensor,
                            .n_sensors = 1,
                            .technique = ORL_TECHNIQUE_BACKWARD,
                            .samples = 1024},
        &lx);
    const double wanted = 2 * 600 / (60. * 60);
    if (!(fabs(lx / wanted - 1) < .01))
        fail_msg("%g lx, not %g", lx, wanted);
}

/* ---- Geometry of luminaires ------------------------------------------------------------------ */

#define LOOKS                                                                                      \
    "IESNA:LM-63-1995\n \t[LUMINOUSGEOMETRY] looks.mgf \r\nTILT=NONE\n1 1000 2 4 1 1 2 .3 .6 .2\n" \
    "1 1 40\n" DOWN "0\n" ONE

/* Runs !ies2rad with a luminaire in a folder, and its geometry if there is one. */
static int read_looks(const char *command, const char *mgf, struct orl_parsed_scene *ret,
                      struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "sub/lamp.ies", "sub/looks.mgf"};
    const struct orl_file contents[] = {{command, strlen(command), NULL},
                                        {LOOKS, strlen(LOOKS), NULL},
                                        {mgf, mgf ? strlen(mgf) : 0, NULL}};
    struct orl_memory_files memory = {names, contents, mgf ? 3 : 2};
    const struct orl_files provider = orl_files_from_memory(&memory);
    *err = (struct orl_error){0};
    return orl_scene_parse(names, 1, &provider, ret, err);
}

/* The output matches ies2rad -dc -m .8: an illum, and in it lamps that glow as far as the
 * opening's diagonal, .7 m, times the factors of the measurement. */
static void test_geometry(void **state)
{
    static const char mgf[] = "m shine =\n ed 3000\nv a =\n p 0 .1 0\nv b =\n p .1 0 0\nv c =\n "
                              "p 0 0 0\no bar\nf a b c\no\n";
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    if (read_looks("!ies2rad -dc -m .8 sub/lamp.ies\n", mgf, &d, &err) < 0)
        fail_msg("%s:%d: %s", err.file, err.line, err.message);
    assert_int_equal(d.n_surfaces, 2);
    const struct orl_material *const light = &d.materials[d.surfaces[0].material];
    const struct orl_material *const shine = &d.materials[d.surfaces[1].material];
    assert_int_equal(light->kind, ORL_MATERIAL_ILLUM);
    assert_int_equal(shine->kind, ORL_MATERIAL_GLOW);
    assert_true(fabs(orl_glow_of(shine)->max_radius - 70) < 1e-4);
    assert_true(fabs(shine->color.g / (1.6 * 3000 / (179 * M_PI)) - 1) < 1e-5);
    assert_true(fabs(d.surfaces[1].vertices[0].y - 10) < 1e-9);
    orl_parsed_scene_done(&d);
    assert_true(read_looks("!ies2rad sub/lamp.ies\n", "\nv a b\n", &d, &err) < 0);
    assert_string_equal(err.file, "sub/looks.mgf");
    assert_int_equal(err.line, 2);
}

/* If the geometry file is missing, the luminaire is a light without it. */
static void test_geometry_is_missing(void **state)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    assert_int_equal(read_looks("!xform -t 0 0 1 sub/lamp.ies\n", NULL, &d, &err), 0);
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.materials[d.surfaces[0].material].kind, ORL_MATERIAL_LIGHT);
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(d.warnings[0], "looks.mgf, is missing"));
    orl_parsed_scene_done(&d);
}

/* The radius of -i is in the scene's units, as in ies2rad. */
static void test_radius(void **state)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    assert_int_equal(read_looks("!ies2rad -dc -i 5 sub/lamp.ies\n", NULL, &d, &err), 0);
    assert_int_equal(d.surfaces[0].kind, ORL_SURFACE_SPHERE);
    assert_true(fabs(d.surfaces[0].quadric->radius[0] - 5) < 1e-9);
    orl_parsed_scene_done(&d);
    assert_int_equal(read_looks("!ies2rad -dc -i .01 sub/lamp.ies\n", NULL, &d, &err),
                     ORL_ERR_RANGE);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text;
        int code, line;
        const char *says;
    } cases[] = {
        {"IESNA91\nTILT=INCLUDE\n4 2 0 90 1 .5\n", ORL_ERR_SYNTAX, 3, "lamp-to-luminaire"},
        {"IESNA91\nTILT=INCLUDE\n1 2 0 90\n1 -.5\n", ORL_ERR_RANGE, 4, "negative"},
        {"IESNA91\nTILT=INCLUDE\n1 2 0 90 1 .5\n", ORL_ERR_SYNTAX, 4, "ends"},
        {"IESNA91\nTILT=\n", ORL_ERR_SYNTAX, 2, "TILT"},
        {"IESNA91\nTILT=none.such\n1 1000 1 4 1 1 2 0 0 0\n1 1 40\n" DOWN "0\n" ONE,
         ORL_ERR_NOT_FOUND, 0, "none.such"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 3 2 0 0 0\n1 1 40\n" DOWN "0\n" ONE, ORL_ERR_UNSUPPORTED,
         4, "type"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 1 7 0 0 0\n1 1 40\n" DOWN "0\n" ONE, ORL_ERR_SYNTAX, 4,
         "units"},
        {"IESNA91\nTILT=NONE\n1 1000 1 9999999 1 1 2 0 0 0\n1 1 40\n" DOWN "0\n" ONE,
         ORL_ERR_SYNTAX, 3, "angles"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 40\n0 60 30 90\n0\n" ONE, ORL_ERR_SYNTAX,
         5, "rise"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 40\n" DOWN "0\n300 200\n", ORL_ERR_SYNTAX,
         8, "ends"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 40\n" DOWN "0\n300 -2 1 0\n",
         ORL_ERR_RANGE, 7, "negative"},
        {"IESNA91\nTILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 40\n" DOWN "0\n300 x 1 0\n",
         ORL_ERR_SYNTAX, 7, "number"},
        {"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 4 1 1 2 -.1 0 .3\n1 1 40\n" DOWN "0\n" ONE,
         ORL_ERR_RANGE, 0, "shape"},
        {"300 200\n", ORL_ERR_SYNTAX, 0, "TILT="},
    };
    static const struct orl_sensor sensor = {{0, 0, -3}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_error err = {0};
        const int code = scene_run_fails(&(struct scene_run){.scene = "!ies2rad lamp.ies\n",
                                                             .resource_name = "lamp.ies",
                                                             .resource_text = cases[i].text,
                                                             .sensors = &sensor,
                                                             .n_sensors = 1},
                                         &err);
        if (code != cases[i].code || strcmp(err.file, "lamp.ies") != 0 ||
            (cases[i].line > 0 && err.line != cases[i].line) || !strstr(err.message, cases[i].says))
            fail_msg("case %zu: %d, %s:%d: %s", i, code, err.file, err.line, err.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_far_away),
        cmocka_unit_test(test_long_head),
        cmocka_unit_test(test_beyond_the_angles),
        cmocka_unit_test(test_missing_planes),
        cmocka_unit_test(test_units_and_colors),
        cmocka_unit_test(test_geometry),
        cmocka_unit_test(test_geometry_is_missing),
        cmocka_unit_test(test_radius),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
