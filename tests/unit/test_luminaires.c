/*
 * IES files as luminaires, by ies2rad and by themselves: far away each gives the intensity that it
 * was measured with, whatever its shape; and what is wrong with a file is told with its line.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support/scene_text.h"

#define DOWN "0 30 60 90\n"
#define ROUND "0 30 60 120 150 180\n"
/* By vertical angle: of one horizontal angle, of three in a quadrant, of one all round. */
#define ONE "300 200 100 0\n"
#define THREE "300 200 100 0\n300 150 50 0\n300 120 30 0\n"
#define ALL "50 100 150 120 80 40\n"

struct file {
    const char *text;
    double vertical, horizontal, candela; /* where it is looked at, and what it gives there */
};

static const struct file files[] = {
    /* flat, by quadrants; halfway between two horizontal angles, too */
    {"IESNA:LM-63-1995\n[TEST] one\nTILT=NONE\n1 1000 2 4 3 1 2 .3 .6 0\n1 1 40\n" DOWN
     "0 45 90\n" THREE,
     30, 45, 300},
    {"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 4 3 1 2 .3 .6 0\n1 1 40\n" DOWN "0 45 90\n" THREE, 60,
     112.5, 40},
    /* a disc in feet, its factors those of 1991 */
    {"IESNA91\r\nTILT=NONE\r\n1 1000 1 4 1 1 1 -1 0 0\r\n.9 .5 40\r\n" DOWN "0\r\n" ONE, 30, 200,
     90},
    /* a box, a cylinder, a ball and a point, that shine upwards, too */
    {"IESNA:LM-63-2002\nTILT=NONE\n1,1000,1,6,1,1,2,.3,.6,.2\n1,1,40\n" ROUND "0\n" ALL, 60, 20,
     150},
    {"IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 6 1 1 2 -.2 0 .3\n1 1 40\n" ROUND "0\n" ALL, 120, 300,
     120},
    {"IES:LM-63-2019\nTILT=NONE\n1 1000 1 6 1 1 2 -.2 -.2 -.2\n1 1 40\n" ROUND "0\n" ALL, 150, 0,
     80},
    {"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 6 1 1 2 0 0 0\n1 1 40\n" ROUND "0\n" ALL, 30, 0, 100},
};

/* 60 m away openings are points: a face of half a metre is nearer by a hundredth at most. */
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

/* In millimetres: 60 000 of them away. The colour is the lamp's. */
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

static void test_refused(void **state)
{
    static const struct {
        const char *text;
        int code, line;
        const char *says;
    } cases[] = {
        {"IESNA91\nTILT=INCLUDE\n4 2 0 90 1 .5\n", ORL_ERR_SYNTAX, 3, "lies"},
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
        cmocka_unit_test(test_units_and_colors),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
