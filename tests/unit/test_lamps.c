/* Luminaire tables and their effect: colour, depreciation, and the share by tilt. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/parse/luminaire/luminaires.h"
#include "support/cli.h"
#include "support/scene_text.h"
#include "support/scratch.h"

static const char table_text[] = "# lamps of ours\n"
                                 "\n"
                                 "/deep red/\t.6 .3 .5\n"
                                 "  |warm[- ]white| .44 .4 .85   # with a word behind it\n"
                                 "/warm\\/glow/ (warm white)\n"
                                 "/\\<hps\\>/ (warm/glow)\n"
                                 "/[EP]AR/ .45 .41 .95\n"
                                 "/x[^0-9]z*y/ .31 .33 .1\n"
                                 "/^only/ .31 .33 .2\n"
                                 "/only$/ .31 .33 .3\n"
                                 "/a.*b\\>.*c/ .31 .33 .4\n";

static struct orl_lamp_table table_of(const char *text)
{
    return (struct orl_lamp_table){"lamp.tab", text, strlen(text), ORL_LAMP_STEPS};
}

static void test_patterns(void **state)
{
    static const struct {
        const char *words;
        double share; /* 0: none */
    } cases[] = {{"a DEEP Red lamp", .5},
                 {"Warm-White 40 W", .85},
                 {"warm white", .85},
                 {"warm_white", 0},
                 {"Warm/Glow", .85},
                 {"400W HPS", .85},
                 {"400W HPSX", 0},
                 {"_hps", 0},
                 {"hps/2", .85},
                 {"PAR 38", .95},
                 {"par 38", 0},
                 {"xay", .1},
                 {"xazzzy", .1},
                 {"xa", 0},
                 {"x0zy", 0},
                 {"only this", .2},
                 {"this only", .3},
                 {"this only one", 0},
                 {"a tab and c", .4},
                 {"a tabs and c", 0},
                 {"", 0},
                 {"nothing", 0}};
    struct orl_lamp_table table = table_of(table_text);
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_lamp_entry lamp = {.share = 0};
        struct orl_error err = {0};
        const int code = orl_lamp_find(&table, cases[i].words, strlen(cases[i].words), &lamp, &err);
        if (code != (cases[i].share > 0) || lamp.share != cases[i].share)
            fail_msg("'%s': %d, %g %s", cases[i].words, code, lamp.share, err.message);
    }
}

/* Worked out by hand: XYZ of x y and luminance .5 is (1, .5, 1/6). Blue is below 0, so all
 * channels move towards grey of .5 by .5/(.5 - blue). */
static void test_color(void **state)
{
    struct orl_lamp_table table = table_of(table_text);
    struct orl_lamp_entry lamp;
    (void)state;
    assert_int_equal(orl_lamp_find(&table, "deep red", 8, &lamp, NULL), 1);
    const double blue = (183 * 1. - 617 * .5 + 2883 / 6.) / 2449;
    const double green = (-2589 * 1. + 5011 * .5 + 111 / 6.) / 2533;
    const double red = (2337 * 1. - 1063 * .5 - 363 / 6.) / 911;
    const double least = blue < green ? blue : green, left = .5 / (.5 - least);
    assert_true(least < 0);
    assert_true(fabs(lamp.color.r - (.5 + left * (red - .5))) < 1e-12);
    assert_true(fabs(lamp.color.g - (.5 + left * (green - .5))) < 1e-12);
    assert_true(fabs(lamp.color.b - (.5 + left * (blue - .5))) < 1e-12);
    assert_true(fabs(orl_luma(lamp.color) - .5) < 1e-4);
}

static void test_tables_that_are_wrong(void **state)
{
    static const struct {
        const char *text;
        int code, line;
    } cases[] = {
        {"/x/ .3 .3 1\n/lamp .3 .3 1\n", ORL_ERR_SYNTAX, 2},
        {"/lamp/ .3 .3\n", ORL_ERR_SYNTAX, 1},
        {"/lamp/\n", ORL_ERR_SYNTAX, 1},
        {"/lamp/ .3 0 1\n", ORL_ERR_RANGE, 1},
        {"/lamp/ .7 .7 1\n", ORL_ERR_RANGE, 1},
        {"/lamp/ .3 .3 -1\n", ORL_ERR_RANGE, 1},
        {"/x/ .3 .3 1\n/lamp/ (y)\n", ORL_ERR_SYNTAX, 2},
        {"/lamp/ (lamp)\n", ORL_ERR_SYNTAX, 1},
        {"/.*.*.*.*.*.*.*.*.*.*.*.*X/ .3 .3 1\n", ORL_ERR_LIMIT, 1},
    };
    static const char words[] = "lamp lamp lamp lamp lamp lamp lamp lamp lamp lamp lamp lamp lamp";
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_lamp_table table = table_of(cases[i].text);
        struct orl_lamp_entry lamp;
        struct orl_error err = {0};
        const int code = orl_lamp_find(&table, words, sizeof words - 1, &lamp, &err);
        if (code != cases[i].code || err.line != cases[i].line || strcmp(err.file, "lamp.tab") != 0)
            fail_msg("case %zu: %d, %s:%d: %s", i, code, err.file, err.line, err.message);
    }
}

/* Each name but the first refers to the one before it: chains of 32 and of 33 names. */
static void test_names_of_names(void **state)
{
    (void)state;
    for (int n = 32; n <= 33; n++) {
        char text[2048], words[16];
        struct orl_lamp_entry lamp;
        struct orl_error err = {0};
        int at = snprintf(text, sizeof text, "/lamp 0$/ .3 .3 .7\n");
        for (int i = 1; i <= n; i++)
            at += snprintf(text + at, sizeof text - (size_t)at, "/lamp %d$/ (lamp %d)\n", i, i - 1);
        snprintf(words, sizeof words, "lamp %d", n);
        struct orl_lamp_table table = table_of(text);
        const int code = orl_lamp_find(&table, words, strlen(words), &lamp, &err);
        if (code != (n == 32 ? 1 : ORL_ERR_LIMIT))
            fail_msg("%d names: %d, %s", n, code, err.message);
    }
}

/* ---- Luminaires ------------------------------------------------------------------------------ */

#define NUMBERS "1 1000 1 3 1 1 2 0 0 0\n1 1 40\n0 90 180\n0\n1000 1000 1000\n"

static const double radius = 30; /* a point of 1000 cd in all directions: 1000/900 lx */

static double lux_of(const char *scene)
{
    static const char *const names[] = {"scene.rad"};
    static const struct orl_sensor sensor = {{0, 0, -30}, {0, 0, 1}};
    double lx = 0;
    cli_write_file(scratch_path(""), "scene.rad", scene);
    scene_run_lx(&(struct scene_run){.source = scratch_path(""),
                                     .names = names,
                                     .n_names = 1,
                                     .sensors = &sensor,
                                     .n_sensors = 1,
                                     .technique = ORL_TECHNIQUE_BACKWARD,
                                     .samples = 1024},
                 &lx);
    return lx / (1000 / (radius * radius));
}

/* Checks the share of 1000 cd for each row. Radiances in the generated text have six digits, and
 * RGB's white has an error of the same size. */
static void expect_shares(const char *const (*rows)[2], const double *shares, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        cli_write_file(scratch_path(""), "lamp.ies", rows[i][0]);
        const double share = lux_of(rows[i][1]);
        if (!(fabs(share - shares[i]) < 1e-4))
            fail_msg("row %zu: %.6f, not %.6f", i, share, shares[i]);
    }
}

static void test_lamps_by_the_table(void **state)
{
    static const char with[] = "IESNA:LM-63-2002\n[LUMINAIRE] deep red\n [LAMPCAT] nothing\n"
                               "[LAMP] 20 W Warm White, deep red\n[LAMP] HPS\nTILT=NONE\n" NUMBERS,
                      without[] = "IESNA91\n[MORE] deep red\nTILT=NONE\n" NUMBERS,
                      old[] = "A lamp\n  of deep red  \nTILT=NONE\n" NUMBERS;
    static const char plain[] = "!ies2rad -s lamp.ies\n";
    static const char *const rows[][2] = {
        {with, plain},
        {with, "!xform -t 0 0 0 lamp.ies\n"},
        {with, "!ies2rad -t default lamp.ies\n"},
        {with, "!ies2rad -t default -c .5 .5 .5 lamp.ies\n"},
        {with, "!ies2rad -c .5 .5 .5 lamp.ies\n"},
        {with, "!ies2rad -t 'PAR' -m 2 lamp.ies\n"},
        {with, "!ies2rad -t 'none such' -c .25 .25 .25 lamp.ies\n"},
        {with, "!ies2rad -t default -u PAR lamp.ies\n"},
        {with, "!ies2rad -f other.tab lamp.ies\n"},
        {without, plain},
        {without, "!ies2rad -u hps lamp.ies\n"},
        {without, "!ies2rad -t nothing -u hps lamp.ies\n"},
        {old, plain},
    };
    static const double shares[] = {.5, .5, 1, .5, .5, 1.9, .25, .95, .7, 1, .85, .85, .5};
    (void)state;
    cli_write_file(scratch_path(""), "lamp.tab", table_text);
    cli_write_file(scratch_path(""), "other.tab", "/white/ .3333 .3333 .7\n");
    /* The first line of the table whose pattern is in the words counts, not the first words. */
    expect_shares(rows, shares, sizeof rows / sizeof *rows);
}

static void test_lamps_without_a_table(void **state)
{
    static const char lamp[] = "IESNA:LM-63-2002\n[LAMP] deep red\nTILT=NONE\n" NUMBERS;
    static const char *const rows[][2] = {{lamp, "!ies2rad lamp.ies\n"},
                                          {lamp, "!ies2rad -t PAR -c .5 .5 .5 lamp.ies\n"}};
    static const double shares[] = {1, .5};
    (void)state;
    expect_shares(rows, shares, 2);
}

/* A tilted point source gives the share for its angle. */
static void test_tilt(void **state)
{
    static const char half[] = "IESNA:LM-63-1995\nTILT=INCLUDE\n1\n3\n0 30 90\n1 .7 .1\n" NUMBERS,
                      whole[] = "IESNA91\nTILT=INCLUDE\n3 4\n0 90 135 180\n1 .5 .6 .8\n" NUMBERS,
                      file[] = "IESNA91\nTILT=lamp.tlt\n" NUMBERS;
    static const char *const rows[][2] = {
        {half, "!ies2rad lamp.ies\n"},
        {half, "!ies2rad lamp.ies | xform -rx 15\n"},
        {half, "!ies2rad lamp.ies | xform -ry -30 -rz 20\n"},
        {half, "!ies2rad lamp.ies | xform -rz 77 -ry 60 -s 2 -s .5\n"},
        {half, "!xform -rx 150 lamp.ies\n"},
        {whole, "!ies2rad lamp.ies\n"},
        {whole, "!ies2rad lamp.ies | xform -ry 90\n"},
        {whole, "!ies2rad lamp.ies | xform -rx 135\n"},
        {whole, "!ies2rad lamp.ies | xform -rx 180\n"},
        {file, "!ies2rad lamp.ies | xform -rx 60\n"},
        {file, "!ies2rad lamp.ies | xform -rx 75\n"},
    };
    static const double shares[] = {1, .85, .7, .4, .7, 1, .5, .6, .8, .25, .25};
    (void)state;
    cli_write_file(scratch_path(""), "lamp.tlt", "2\n2\n0 60\n1 .25\n");
    expect_shares(rows, shares, sizeof rows / sizeof *rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patterns),
        cmocka_unit_test(test_color),
        cmocka_unit_test(test_tables_that_are_wrong),
        cmocka_unit_test(test_names_of_names),
        cmocka_unit_test_setup_teardown(test_lamps_by_the_table, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_lamps_without_a_table, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_tilt, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
