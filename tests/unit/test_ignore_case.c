/* File names that differ only in case: candidates in folders, and in error messages. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "support/scratch.h"
#include <oriel/base/files.h>

static void write_file(const char *name)
{
    FILE *stream = fopen(scratch_path(name), "w");
    assert_non_null(stream);
    assert_int_equal(fclose(stream), 0);
}

static void make_files(void)
{
    write_file("MATERIALS.MAT");
    assert_int_equal(mkdir(scratch_path("Model"), 0700), 0);
    write_file("Model/room.RAD");
    write_file("Model/Room.rad");
}

static void test_candidates(void **state)
{
    static const struct {
        const char *name, *other; /* NULL: none */
    } cases[] = {{"materials.mat", "MATERIALS.MAT"},
                 {"./materials.mat", "./MATERIALS.MAT"},
                 {"model/ROOM.rad", "Model/Room.rad"},
                 {"Model/../materials.Mat", "Model/../MATERIALS.MAT"},
                 {"MATERIALS.MAT", NULL}, /* it exists as written */
                 {"material.mat", NULL},
                 {"models/room.rad", NULL},
                 {"", NULL}};
    char found[256];
    (void)state;
    make_files();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool is_there =
            orl_find_ignoring_case(scratch_path(""), cases[i].name, found, sizeof found);
        if (is_there != (cases[i].other != NULL))
            fail_msg("%s: %s", cases[i].name, is_there ? found : "nothing");
        if (is_there)
            assert_string_equal(found, cases[i].other);
    }
    assert_false(
        orl_find_ignoring_case(scratch_path(""), "model/ROOM.rad", found, 8)); /* no room */
}

static void test_errors(void **state)
{
    char folder[256];
    struct orl_file file;
    struct orl_error err = {0};
    (void)state;
    make_files();
    snprintf(folder, sizeof folder, "%s", scratch_path(""));
    const struct orl_files files = orl_files_from_folder(folder);
    assert_int_equal(files.open(files.ctx, "materials.mat", &file, &err), ORL_ERR_NOT_FOUND);
    assert_non_null(strstr(err.hint, "there is 'MATERIALS.MAT'"));
    assert_int_equal(files.open(files.ctx, "other.mat", &file, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.hint, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_candidates, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_errors, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
