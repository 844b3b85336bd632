/* Configuration files of frads as projects. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "project/project.h"

static void assert_member(const json_t *project, const char *member, const char *wanted)
{
    char *text = json_dumps(json_object_get(project, member), JSON_COMPACT);
    assert_string_equal(text, wanted);
    free(text);
}

static json_t *read_text(const char *text)
{
    json_t *project = NULL;
    struct orl_error err = {0};
    if (orl_frads_read("room.cfg", text, strlen(text), &project, &err) < 0)
        fail_msg("%s", err.message);
    return project;
}

/* Values that continue on the next line, name others, or belong to another section. */
static void test_files(void **state)
{
    json_t *const project =
        read_text("; a room\n[Site]\nepw_file = a.epw\n\n[Model]\nDir = objects\n"
                  "material = ${dir}/a.mat\nwindows =\n\n"
                  "scene = ${dir}/walls.rad\n\t${Model:dir}/floor.rad\n"
                  "# a comment\n    sky.rad\nncps: fins.rad\n");
    (void)state;
    assert_member(project, "files",
                  "[\"objects/a.mat\",\"objects/walls.rad\",\"objects/floor.rad\",\"sky.rad\","
                  "\"fins.rad\"]");
    assert_member(project, "views", "[]");
    assert_member(project, "left_out",
                  "[{\"file\":\"a.epw\",\"why\":\"weather: give it to \\\"oriel annual\\\" with "
                  "--weather\"}]");
    json_decref(project);
}

static void test_windows(void **state)
{
    json_t *const project = read_text("[Model]\nscene = s.rad\nwindows = a.rad b.rad\n"
                                      "window_xmls = one.xml\nwindow_cfs = c.rad\n");
    json_t *const plain = read_text("[Model]\nscene = s.rad\nwindows = a.rad b.rad\n");
    (void)state;
    assert_member(project, "files", "[\"+window-1.rad\",\"+window-2.rad\",\"s.rad\"]");
    const json_t *const second = json_array_get(json_object_get(project, "commands"), 1);
    assert_string_equal(json_string_value(json_object_get(second, "text")),
                        "void BSDF frads.window.2 6 0 \"one.xml\" 0 0 1 . 0 0\n"
                        "!xform -m frads.window.2 \"b.rad\"\n");
    assert_int_equal(json_array_size(json_object_get(project, "left_out")), 1);
    assert_member(plain, "files", "[\"a.rad\",\"b.rad\",\"s.rad\"]");
    json_decref(project);
    json_decref(plain);
}

static void test_views(void **state)
{
    json_t *const project =
        read_text("[Model]\nscene = s.rad\n[RaySender]\nview = -vf in.vf -x 400 -y 300\nview2 =\n"
                  "view_up = -vta -vp 1 2 3 -vd 0 0 1 -x 0\ngrid_surface = floor.rad\n");
    (void)state;
    assert_member(project, "views",
                  "[{\"name\":\"view\",\"file\":\"in.vf\",\"width\":400,\"height\":300},"
                  "{\"name\":\"view_up\",\"view\":\"-vta -vp 1 2 3 -vd 0 0 1\",\"width\":800,"
                  "\"height\":800}]");
    assert_int_equal(json_array_size(json_object_get(project, "left_out")), 1);
    json_decref(project);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *message;
        int line;
    } cases[] = {
        {"[Model]\nmaterial = a.mat\n", "no scene files", 0},
        {"scene = a.rad\n", "assigns nothing", 1},
        {"[Model]\nscene\n", "assigns nothing", 2},
        {"[Model\n", "not a section", 1},
        {"[Model]\n\nscene = ${dir}/a.rad\n", "does not exist", 3},
        {"[Model]\nscene = ${dir/a.rad\n", "has no closing", 2},
        {"[Model]\nscene = ${a}\na = ${scene}\n", "eight deep", 3},
        {"[Model]\nscene = s\nwindows = a b c\nwindow_xmls = x y\n", "neither one nor", 4},
        {"[Model]\nscene = s\nwindows = !rm\nwindow_xmls = x\n", "'!'", 3},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        json_t *project = NULL;
        struct orl_error err = {0};
        const char *const text = cases[i].text;
        assert_true(orl_frads_read("room.cfg", text, strlen(text), &project, &err) < 0);
        assert_null(project);
        if (!strstr(err.message, cases[i].message) || err.line != cases[i].line)
            fail_msg("case %zu: line %d: %s", i, err.line, err.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_windows),
        cmocka_unit_test(test_views),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
