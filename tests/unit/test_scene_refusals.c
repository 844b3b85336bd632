/*
 * Primitives that are not simulated: listed together in one error, by kind, with the place of the
 * first; ignored if nothing uses them.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

#define RED "void plastic red 0 0 5 .5 .2 .1 0 0\n"

/* One error lists everything that is not simulated: kind, number, first place. Primitives that
 * depend on these give no error of their own. */
static void test_refusals_together(void **state)
{
    static const char text[] =
        "void BRTDfunc bumps\n10 0 0 0 Px Px Px 0 0 0 .\n0\n9 0 0 0 0 0 0 0 0 0\n"
        "bumps plastic rough 0 0 5 .5 .5 .5 0 0\n"
        "void brightfunc cloth 2 Px*T . 0 0\n"
        "cloth metal dressed 0 0 5 .5 .5 .5 .9 0\n"
        "void brightfunc paper 2 Px*T . 0 0\n"
        "rough polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"
        "void alias other rough\nother sphere s 0 0 4 0 0 0 1\n"
        "!gencatenary rough w 0 0 0 1 9\n"
        "dressed ring r 0 0 8 0 0 0 0 0 1 0 1\n";
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(scene_parse_bytes(text, sizeof text - 1, &err), ORL_ERR_UNSUPPORTED);
    assert_string_equal(err.file, "a.rad");
    assert_int_equal(err.line, 1);
    assert_string_equal(err.primitive, "BRTDfunc bumps");
    assert_string_equal(err.message,
                        "not simulated: 1 x BRTDfunc (first at a.rad:1), 1 x !gencatenary (first "
                        "at a.rad:12), 1 x brightfunc (first at a.rad:6)");
    assert_non_null(strstr(err.hint, "BRTDfunc: describe it as a BSDF"));
}

/* Several primitives of one kind: the message is that of a single one, and states their number. */
static void test_refusals_alike(void **state)
{
    static const char text[] = "void brightfunc p 2 T . 0 0\np plastic a 0 0 5 .1 .1 .1 0 0\n"
                               "void brightfunc q 2 2*T . 0 0\nq plastic b 0 0 5 .1 .1 .1 0 0\n"
                               "a sphere s 0 0 4 0 0 0 1\nb sphere t 0 0 4 3 0 0 1\n"
                               "b sphere u 0 0 4 6 0 0 1\n"
                               "nothing polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n";
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(scene_parse_bytes(text, sizeof text - 1, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "its function uses T"));
    assert_non_null(strstr(err.message, "; there are 2 of them"));
    assert_string_equal(err.primitive, "brightfunc p");
}

/* Primitives that no surface uses do not make the scene fail; one warning covers them. */
static void test_unused(void **state)
{
    static const char text[] =
        "void plastic bad 0 0 5 -.13 .1 .1 0 0\n"
        "void BRTDfunc paint 10 0 0 0 Px Px Px 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n"
        "paint alias other paint\n"
        "void BRTDfunc bumps 10 0 0 0 Px Px Px 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n"
        "bumps plastic rough 0 0 5 .5 .5 .5 0 0\n"
        "void BSDF blind 6 0 gone.xml 0 0 1 . 0 0\n"
        "void plastic good 0 0 5 .5 .5 .5 0 0\ngood sphere s 0 0 4 0 0 0 1\n";
    struct orl_parsed_scene d = scene_parse_text(text, NULL, NULL);
    (void)state;
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.n_warnings, 1);
    assert_string_equal(d.warnings[0],
                        "plastic bad at scene.rad:1 is ignored because nothing uses it, and 3 "
                        "others like it: its reflectance (-0.13 0.1 0.1) is not from 0 to 1");
    orl_parsed_scene_done(&d);
}

/* Libraries of materials contain unused primitives, also patterns on materials and aliases. */
static void test_refusals_unused(void **state)
{
    static const char library[] =
        "void BRTDfunc bumps\n10 0 0 0 Px Px Px 0 0 0 .\n0\n9 0 0 0 0 0 0 0 0 0\n"
        "bumps plastic rough 0 0 5 .5 .5 .5 0 0\n"
        "void alias coarse rough\n"
        "void BRTDfunc pane 10 0 0 0 Px 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n"
        "void brightfunc dirt 2 Px*T . 0 0\n"
        "dirt glow lamp 0 0 4 1 1 1 0\n"
        "void illum window 1 pane 0 3 1 1 1\n" RED;
    static const char *const users[] = {"coarse sphere", "pane sphere", "lamp sphere",
                                        "window sphere"};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(scene_parse_bytes(library, sizeof library - 1, &err), 0);
    for (size_t i = 0; i < sizeof users / sizeof *users; i++) {
        char text[2048];
        static const int lines[] = {1, 7, 8, 7};
        snprintf(text, sizeof text, "%s%s s 0 0 4 0 0 0 1\n", library, users[i]);
        assert_int_equal(scene_parse_bytes(text, strlen(text), &err), ORL_ERR_UNSUPPORTED);
        assert_int_equal(err.line, lines[i]);
    }
}

/* If there are more kinds than fit, the list is cut and says so. */
static void test_refusals_without_end(void **state)
{
    char text[4096] = "";
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 60; i++)
        snprintf(text + strlen(text), 40, "!command%d x\n", i);
    assert_int_equal(scene_parse_bytes(text, strlen(text), &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "1 x !command7 (first at a.rad:8)"));
    assert_string_equal(err.message + strlen(err.message) - 3, "...");
}

/* Blanks between '!' and the command's name are not part of the kind. */
static void test_refusals_of_commands_with_a_blank(void **state)
{
    static const char text[] = "!  cat *.rad\n! genless\nvoid no m 0 0 0\n";
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(scene_parse_bytes(text, strlen(text), &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "1 x !cat (first at a.rad:1), 1 x !genless (first"));
    assert_non_null(strstr(err.hint, "!cat: run it beforehand"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refusals_together),
        cmocka_unit_test(test_refusals_alike),
        cmocka_unit_test(test_unused),
        cmocka_unit_test(test_refusals_unused),
        cmocka_unit_test(test_refusals_without_end),
        cmocka_unit_test(test_refusals_of_commands_with_a_blank),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
