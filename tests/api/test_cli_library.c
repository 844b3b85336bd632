/* Function files and fonts that a scene needs but does not contain: those of the RAYPATH folders,
 * for `oriel run` and for uploads by `oriel submit`. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "support/canned.h"

#define SCENE_ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

/* A glowing disc above the sensor, whose brightness is a function: 10 times .5 everywhere. The
 * ground, which the sensor does not see, uses a name for which this program has a built-in text. */
static const char room[] = "void brightfunc dim\n2 half half.cal\n0\n0\n"
                           "dim glow lamp\n0\n0\n4 10 10 10 0\n"
                           "lamp ring disc\n0\n0\n8 0 0 1  0 0 -1  0 1\n"
                           "void brightfunc flat\n2 noneg(1) source.cal\n0\n0\n"
                           "flat plastic grey\n0\n0\n5 .5 .5 .5 0 0\n"
                           "grey ring ground\n0\n0\n8 0 0 -1  0 0 1  0 1\n";
static const char job[] = "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]},"
                          " \"technique\": \"backward\", \"gather_samples\": 8192,"
                          " \"sensors\": [[0, 0, 0, 0, 0, 1]]}";

static int set_up(void **state)
{
    char library[128], path[160];
    const int code = canned_set_up(state);
    const struct canned_daemon *f = *state;

    snprintf(library, sizeof library, "%s/library", f->folder);
    mkdir(library, 0700);
    cli_write_file(library, "half.cal", "half = .5;\n");
    cli_write_file(library, "source.cal", "this is no function file\n");
    snprintf(path, sizeof path, "/no/such/folder::%s", library);
    setenv("RAYPATH", path, 1);
    cli_write_file(f->folder, "room.rad", room);
    cli_write_file(f->folder, "job.json", job);
    return code;
}

static int tear_down(void **state)
{
    unsetenv("RAYPATH");
    return canned_tear_down(state);
}

/* Returns the illuminance of the sensor; expects that exit code. */
static double run_job(struct canned_daemon *f, int exit_code)
{
    char document[96], output[96];

    snprintf(document, sizeof document, "%s/job.json", f->folder);
    snprintf(output, sizeof output, "%s/out", f->folder);
    const char *const args[] = {"run", document, "-o", output, NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, exit_code);
    char *const text = cli_read_file(output, "result.json");
    json_t *const result = json_loads(text, 0, NULL);
    const json_t *const sensor = json_array_get(json_object_get(result, "sensors"), 0);
    const double value = json_number_value(json_object_get(sensor, "illuminance_lx"));

    json_decref(result);
    free(text);
    return value;
}

static void test_run_finds_function_files_by_raypath(void **state)
{
    struct canned_daemon *f = *state;
    /* E = L pi sin^2(45 degrees), in lux; the estimate's relative error is .0062 (a share of .5 of
     * 8192 paths), and the bounds are eight of these. */
    const double whole = 10 * 3.14159265358979 * .5 * 179;
    const double half = run_job(f, 0);

    assert_true(half > .95 * .5 * whole && half < 1.05 * .5 * whole);
    /* A file beside the scene takes precedence. */
    cli_write_file(f->folder, "half.cal", "half = .25;\n");
    const double quarter = run_job(f, 0);
    assert_true(quarter > .95 * .25 * whole && quarter < 1.05 * .25 * whole);
}

static void test_without_raypath_the_error_says_where_to_put_it(void **state)
{
    struct canned_daemon *f = *state;

    unsetenv("RAYPATH");
    run_job(f, 1);
    canned_says(f->result.err, "room.rad:1: brightfunc dim: there is no function file 'half.cal'");
    canned_says(f->result.err, "RAYPATH");
}

static void test_what_is_sent_carries_the_library_s_files(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
        {"POST /v1/jobs", 202, "{\"id\": \"42\", \"state\": \"queued\"}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char document[96];

    snprintf(document, sizeof document, "%s/job.json", f->folder);
    canned_run(f, canned, "submit", document, NULL);
    assert_int_equal(f->result.exit_code, 0);
    const char *const upload = canned_find(f, "POST /v1/scenes")->body;
    canned_says(upload, "name=\"resource\"; filename=\"half.cal\"");
    canned_says(upload, "half = .5;");
    assert_null(strstr(upload, "no function file"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_run_finds_function_files_by_raypath),
        TEST(test_without_raypath_the_error_says_where_to_put_it),
        TEST(test_what_is_sent_carries_the_library_s_files),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
