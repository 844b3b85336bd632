/* Choice of the scene files of a folder without an explicit list, and their order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "project/main_files.h"

enum { MOST = 8 };

struct entry {
    const char *name, *text;
};

/* Returns the chosen names, in order, separated by blanks. Entries are sorted by name. */
static const char *choose_files(const struct entry *entries, size_t count)
{
    static char chosen[256];
    const char *names[MOST];
    struct orl_file contents[MOST];
    size_t order[MOST], n = 0, length = 0;
    struct orl_error err;
    for (size_t i = 0; i < count; i++) {
        names[i] = entries[i].name;
        contents[i] = (struct orl_file){.data = entries[i].text, .size = strlen(entries[i].text)};
        assert_true(i == 0 || strcmp(names[i - 1], names[i]) < 0);
    }
    struct orl_memory_files memory = {names, contents, count};
    const struct orl_files files = orl_files_from_memory(&memory);
    assert_int_equal(orl_main_files_choose(names, count, &files, order, &n, &err), 0);
    chosen[0] = '\0';
    for (size_t i = 0; i < n; i++)
        length += (size_t)snprintf(chosen + length, sizeof chosen - length, "%s%s", i ? " " : "",
                                   names[order[i]]);
    return chosen;
}

#define CHOOSE(...)                                                                                \
    choose_files((const struct entry[]){__VA_ARGS__},                                              \
                 sizeof((const struct entry[]){__VA_ARGS__}) / sizeof(struct entry))

#define GREY "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
#define BALL "grey sphere ball 0 0 4 0 0 0 1\n"

/* Materials come before their uses, regardless of names; otherwise names decide. */
static void test_definitions_come_first(void **state)
{
    (void)state;
    assert_string_equal(
        CHOOSE({"a_room.rad", BALL}, {"b_other.rad", ""}, {"z_materials.rad", GREY}),
        "b_other.rad z_materials.rad a_room.rad");
    assert_string_equal(CHOOSE({"a.rad", BALL}, {"b.rad", GREY BALL}, {"c.rad", "#" GREY}),
                        "b.rad a.rad c.rad");
    /* A file does not depend on others for what it defines itself. */
    assert_string_equal(CHOOSE({"a.rad", GREY BALL}, {"b.rad", GREY}), "a.rad b.rad");
    /* Dependencies through an alias, an illum's other material, a generator, and a transformed
     * file. */
    assert_string_equal(
        CHOOSE({"a.rad", "void alias grey gray grey sphere s 0 0 4 0 0 0 1"},
               {"b.rad", "void illum pane 1 glassy 0 3 1 1 1"},
               {"c.rad", "!genbox wood box 1 1 1\n"},
               {"d.rad", "void plastic gray 0 0 5 1 1 1 0 0 void glass glassy 0 0 3 1 1 1\n"
                         "void plastic wood 0 0 5 1 1 1 0 0\n"}),
        "d.rad a.rad b.rad c.rad");
    assert_string_equal(CHOOSE({"a.rad", "! xform -rz 30 \\\n parts/desk.rad\n"}, {"m.rad", GREY},
                               {"parts/desk.rad", BALL}),
                        "m.rad a.rad");
    assert_string_equal(
        CHOOSE({"a.rad", "skyfunc glow ground 0 0 4 1 1 1 0\n"}, {"b.rad", "!gensky 3 21 12\n"}),
        "b.rad a.rad");
}

/* Material files are read if they define something that no other file defines. */
static void test_materials(void **state)
{
    (void)state;
    assert_string_equal(CHOOSE({"a.rad", BALL}, {"materials.mat", GREY}), "materials.mat a.rad");
    assert_string_equal(CHOOSE({"a.rad", GREY BALL}, {"materials.mat", GREY}), "a.rad");
    assert_string_equal(CHOOSE({"a.rad", BALL}, {"b.rad", GREY}, {"materials.mat", GREY}),
                        "b.rad a.rad");
    assert_string_equal(CHOOSE({"a.rad", BALL}, {"day.mat", GREY}, {"night.mat", GREY}),
                        "day.mat a.rad");
    assert_string_equal(CHOOSE({"a.rad", "dull sphere s 0 0 4 0 0 0 1\n"},
                               {"dull.mat", "grey plastic dull 0 0 5 1 1 1 0 0\n"},
                               {"grey.MAT", GREY},
                               {"other.mat", "void plastic red 0 0 5 1 0 0 0 0\n"}),
                        "grey.MAT dull.mat a.rad");
    assert_string_equal(CHOOSE({"a.rad", BALL}, {"lib/materials.mat", GREY}), "a.rad");
    assert_string_equal(CHOOSE({"in/a.rad", BALL}, {"in/m.mat", GREY}, {"materials.mat", GREY}),
                        "in/m.mat in/a.rad");
    assert_string_equal(CHOOSE({"materials.mat", GREY}), "");
}

/* If files depend on each other, names decide, and all are read. */
static void test_circles(void **state)
{
    (void)state;
    assert_string_equal(CHOOSE({"a.rad", GREY "wood sphere s 0 0 4 0 0 0 1\n"},
                               {"b.rad", "void plastic wood 0 0 5 1 1 1 0 0\n" BALL}),
                        "a.rad b.rad");
}

/* Invalid text does not prevent the choice; the scene's check reports the error. */
static void test_nonsense(void **state)
{
    (void)state;
    assert_string_equal(CHOOSE({"a.rad", "grey sphere ball 0 0 999999999 1"},
                               {"b.rad", "void plastic grey x y"}, {"c.rad", "!"}),
                        "b.rad a.rad c.rad");
    assert_string_equal(CHOOSE({"readme.txt", "void"}), "");
}

/* A job document beside the files lists them; one that lists missing files is ignored. */
static void test_documents(void **state)
{
    static const char other[] = "{\"kind\":\"study\",\"scene\":{\"files\":[\"b.rad\"]}}";
    static const char job[] = "{\"scene\":{\"files\":[\"b.rad\",\"a.rad\"]}}";
    static const char lost[] = "{\"scene\":{\"files\":[\"a.rad\",\"lost.rad\"]}}";
    static const char twice[] = "{\"scene\":{\"files\":[\"a.rad\",\"a.rad\"]}}";
    (void)state;
    assert_string_equal(CHOOSE({"a.rad", ""}, {"a_study.json", other}, {"b.rad", ""}, {"c.rad", ""},
                               {"job.json", job}),
                        "b.rad a.rad");
    assert_string_equal(CHOOSE({"a.rad", ""}, {"b.rad", ""}, {"study.json", other}), "b.rad");
    assert_string_equal(CHOOSE({"a.rad", ""}, {"b.rad", ""}, {"bad.json", "{"}, {"lost.json", lost},
                               {"t.json", twice}),
                        "a.rad b.rad");
    assert_string_equal(CHOOSE({"in/a.rad", ""}, {"in/b.rad", ""}, {"in/job.json", job}),
                        "in/b.rad in/a.rad");
}

/* The shallowest folder with scene files is chosen; two at the same depth are ambiguous. */
static void test_folders(void **state)
{
    (void)state;
    assert_string_equal(CHOOSE({"a/room.rad", ""}, {"b/room.rad", ""}), "");
    assert_string_equal(CHOOSE({"a/deep/room.rad", ""}, {"b/room.rad", ""}), "b/room.rad");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_definitions_come_first),
                                       cmocka_unit_test(test_materials),
                                       cmocka_unit_test(test_circles),
                                       cmocka_unit_test(test_nonsense),
                                       cmocka_unit_test(test_documents),
                                       cmocka_unit_test(test_folders)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
