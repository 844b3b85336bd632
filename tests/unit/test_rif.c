/* Files of Radiance's rad program as projects. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
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

static void test_materials_come_first(void **state)
{
    (void)state;
    static const char text[] = "# a room\nOCTREE = room.oct\nscene= walls.rad \\\n furniture.rad\n"
                               "mat= a.mat\nill= panes.rad # windows\nscene = sky.rad\r\n"
                               "objects= chair.rad\nRES= 400 300\nview= def -vf inside.vf\n"
                               "view= -vtv -vp 1 2 3 -vd 0 1 0\nview= Xvr\nQUAL= Med\n"
                               "view = up -vf inside.vf  -vd 0 0 1\r\n";
    json_t *project = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_rif_read("room.rif", text, sizeof text - 1, &project, &err), 0);
    assert_member(project, "files",
                  "[\"a.mat\",\"panes.rad\",\"walls.rad\",\"furniture.rad\",\"sky.rad\"]");
    assert_member(project, "views",
                  "[{\"name\":\"def\",\"file\":\"inside.vf\",\"width\":400,\"height\":300},"
                  "{\"name\":\"view2\",\"view\":\"-vtv -vp 1 2 3 -vd 0 1 0\",\"width\":400,"
                  "\"height\":300},{\"name\":\"up\",\"file\":\"inside.vf\","
                  "\"view\":\"-vd 0 0 1\",\"width\":400,\"height\":300}]");
    assert_int_equal(json_array_size(json_object_get(project, "left_out")), 2);
    json_decref(project);
}

static void test_commands_become_files(void **state)
{
    (void)state;
    static const char text[] = "scene= a.rad \"!xform -t 1 2 3 b.rad\" 'c.rad'\n";
    json_t *project = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_rif_read("room.rif", text, sizeof text - 1, &project, &err), 0);
    assert_member(project, "files", "[\"a.rad\",\"+command-1.rad\",\"c.rad\"]");
    assert_member(project, "commands",
                  "[{\"name\":\"+command-1.rad\",\"text\":\"!xform -t 1 2 3 b.rad\\n\"}]");
    json_decref(project);
}

/* rpict's option -bv- applies to each view. */
static void test_backs_are_unseen_where_rpict_is_told_so(void **state)
{
    (void)state;
    static const char text[] = "scene= a.rad\nview= a -vp 1 2 3\nview= b -vf b.vf\n"
                               "render= @render.opt\nrender= -ab 1 -bv-\nRES= 8\n";
    json_t *project = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_rif_read("room.rif", text, sizeof text - 1, &project, &err), 0);
    assert_member(project, "views",
                  "[{\"name\":\"a\",\"view\":\"-vp 1 2 3 -bv-\",\"width\":8,\"height\":8},"
                  "{\"name\":\"b\",\"file\":\"b.vf\",\"width\":8,\"height\":8,"
                  "\"view\":\" -bv-\"}]");
    json_decref(project);
}

/* Pictures fit a size with square pixels by default. */
static void test_pixels_have_the_aspect_asked_for(void **state)
{
    (void)state;
    static const struct {
        const char *resolution, *wanted;
    } cases[] = {
        {"640 480 1", "[{\"name\":\"a\",\"view\":\"-vth\",\"width\":640,\"height\":480}]"},
        {"640 480 0 ", "[{\"name\":\"a\",\"view\":\"-vth\",\"width\":640,\"height\":480,"
                       "\"pixel_aspect\":0.0}]"},
        {"640 480 1.25\r", "[{\"name\":\"a\",\"view\":\"-vth\",\"width\":640,\"height\":480,"
                           "\"pixel_aspect\":1.25}]"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[128];
        json_t *project = NULL;
        struct orl_error err = {0};
        snprintf(text, sizeof text, "scene= a.rad\nRES= %s\nview= a -vth\n", cases[i].resolution);
        assert_int_equal(orl_rif_read("a.rif", text, strlen(text), &project, &err), 0);
        assert_member(project, "views", cases[i].wanted);
        json_decref(project);
    }
}

static void assert_refused(const char *text, int line, const char *why)
{
    json_t *project = NULL;
    struct orl_error err = {0};
    assert_true(orl_rif_read("room.rif", text, strlen(text), &project, &err) < 0);
    assert_null(project);
    if (!strstr(err.message, why))
        fail_msg("\"%s\" is not in: %s", why, err.message);
    assert_int_equal(err.line, line);
}

static void test_what_makes_no_scene_is_refused(void **state)
{
    (void)state;
    assert_refused("mat= a.mat\nscene= \"!genbox a b 1 1 1\n", 2, "a quotation mark is not closed");
    assert_refused("scene= a.oct\n", 1, "an octree");
    assert_refused("scene= a.rad \\\n b.rad\nwhat\n", 3, "assigns nothing");
    assert_refused("= a\n", 1, "a name is missing");
    assert_refused("RES= wide\n", 1, "not a resolution");
    assert_refused("RES= 400 300 times\n", 1, "not a resolution");
    assert_refused("RES= 400 300 -1\n", 1, "not a resolution");
    assert_refused("RES= 400 300 1 1\n", 1, "not a resolution");
    assert_refused("scene= \"\"\n", 1, "no name");
    assert_refused("mat= a.mat\n", 1, "no scene files");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_materials_come_first),
        cmocka_unit_test(test_commands_become_files),
        cmocka_unit_test(test_backs_are_unseen_where_rpict_is_told_so),
        cmocka_unit_test(test_pixels_have_the_aspect_asked_for),
        cmocka_unit_test(test_what_makes_no_scene_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
