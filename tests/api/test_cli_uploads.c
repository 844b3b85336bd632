/* The commands that send and remove, run against canned answers: submit, upload, remove. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "support/canned.h"

#define SCENE_ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

static void test_submit_sends_scene_references_and_sensors(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
        {"POST /v1/jobs", 202, "{\"id\": \"42\", \"state\": \"queued\"}"},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    const char *upload, *main_part, *other_part;
    char path[96];
    json_t *job, *wanted = json_loads("[[1, 2, 3, 0, 0, 1], [1.5, 2, 3, 0, 0, -1]]", 0, NULL);

    cli_write_file(f->folder, "room.rad",
                   "void glow g\n0\n0\n4 1 1 1 0\n"
                   "g source sky\n0\n0\n4 0 0 1 180\n"
                   "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n"
                   "!xform -t 0 0 1 chair.rad\n");
    cli_write_file(f->folder, "chair.rad", "p polygon seat\n0\n0\n9 0 0 0 1 0 0 0 1 0\n");
    cli_write_file(f->folder, "unused.rad", "");
    cli_write_file(f->folder, "sensors.txt", "# two\n1 2 3 0 0 1\n\n  1.5 2 3 0 0 -1 # down\n");
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"seed\": 5, \"scene\": {\"files\":"
                   " [\"room.rad\"]}, \"sensors\": {\"file\": \"sensors.txt\"}}");
    snprintf(path, sizeof path, "%s/job.json", f->folder);
    canned_run(f, canned, "submit", path, NULL);
    assert_string_equal(f->result.out, "42\n");
    assert_int_equal(f->result.exit_code, 0);
    upload = canned_find(f, "POST /v1/scenes")->body;
    main_part = strstr(upload, "name=\"file\"; filename=\"room.rad\"");
    other_part = strstr(upload, "name=\"resource\"; filename=\"chair.rad\"");
    assert_true(main_part && other_part && main_part < other_part);
    assert_null(strstr(upload, "unused.rad"));
    job = json_loads(canned_find(f, "POST /v1/jobs")->body, 0, NULL);
    assert_string_equal(json_string_value(json_object_get(job, "scene")), SCENE_ID);
    assert_int_equal(json_integer_value(json_object_get(job, "seed")), 5);
    assert_int_equal(json_array_size(json_object_get(job, "sensors")), 2);
    for (size_t i = 0; i < 12; i++)
        assert_true(json_number_value(json_array_get(
                        json_array_get(json_object_get(job, "sensors"), i / 6), i % 6)) ==
                    json_number_value(json_array_get(json_array_get(wanted, i / 6), i % 6)));
    json_decref(job);
    json_decref(wanted);
}

/* The document is that of `oriel annual` with the same arguments, with its weather beside the
 * scene. */
static void test_submit_a_year_of_a_project(void **state)
{
    static const struct canned canned[] = {
        {"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
        {"POST /v1/jobs", 202, "{\"id\": \"42\", \"state\": \"queued\"}"},
        {NULL, 0, NULL}};
    static const char model[] = "tests/fixtures/honeybee/two_rooms.hbjson";
    static const char weather[] = "tests/fixtures/weather.epw";
    struct canned_daemon *f = *state;
    const char *const year[] = {"submit",   model,     "--weather",
                                weather,    "--rules", "LEED, EN 17037 minimum",
                                "--server", f->url,    NULL};
    const char *const no_weather[] = {"submit", model, "--rules", "LEED", "--server", f->url, NULL};
    const char *const a_sky[] = {"submit", model,      "--weather", weather, "--sky",
                                 "noon",   "--server", f->url,      NULL};

    canned_run_args(f, canned, year);
    assert_string_equal(f->result.out, "42\n");
    canned_says(canned_find(f, "POST /v1/scenes")->body,
                "name=\"resource\"; filename=\"weather.epw\"");
    json_t *job = json_loads(canned_find(f, "POST /v1/jobs")->body, 0, NULL);
    json_t *rules = json_pack("[s, s]", "LEED", "EN 17037 minimum");
    assert_string_equal(json_string_value(json_object_get(job, "kind")), "annual");
    assert_string_equal(json_string_value(json_object_get(job, "weather")), "weather.epw");
    assert_string_equal(json_string_value(json_object_get(job, "scene")), SCENE_ID);
    assert_true(json_equal(json_object_get(job, "rules"), rules));
    assert_int_equal(json_array_size(json_object_get(job, "grids")), 2);
    json_decref(rules);
    json_decref(job);
    canned_run_args(f, canned, no_weather);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "give --weather FILE.epw");
    canned_run_args(f, canned, a_sky);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "--weather for a year");
}

static void test_submit_finds_mistakes_before_sending(void **state)
{
    static const struct canned nothing[] = {{NULL, 0, NULL}};
    static const struct {
        const char *room, *sensors, *says;
    } cases[] = {
        {"void plastic p\n0\n0\n5 .5 .5\n", "1 2 3 0 0 1\n", "room.rad:"},
        {"void glow g\n0\n0\n4 1 1 1 0\n", "1 2 3 0 0 1\n1 2 3 0 0 one\n", "sensors.txt:2:"},
    };
    struct canned_daemon *f = *state;
    char path[96], climbing[160];

    snprintf(path, sizeof path, "%s/job.json", f->folder);
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"scene\": {\"files\":"
                   " [\"room.rad\"]}, \"sensors\": {\"file\": \"sensors.txt\"}}");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cli_write_file(f->folder, "room.rad", cases[i].room);
        cli_write_file(f->folder, "sensors.txt", cases[i].sensors);
        canned_run(f, nothing, "submit", path, NULL);
        assert_int_equal(f->result.exit_code, 1);
        canned_says(f->result.err, cases[i].says);
        assert_string_equal(f->result.out, "");
        assert_int_equal(f->n_requests, 0);
    }
    /* A reference out of the folder works for `oriel run`, but cannot be uploaded. */
    snprintf(climbing, sizeof climbing,
             "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n!xform ../%s/a.rad\n",
             strrchr(f->folder, '/') + 1);
    cli_write_file(f->folder, "room.rad", climbing);
    cli_write_file(f->folder, "a.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    cli_write_file(f->folder, "sensors.txt", "1 2 3 0 0 1\n");
    canned_run(f, nothing, "submit", path, NULL);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "lies outside the scene's folder");
    assert_int_equal(f->n_requests, 0);
}

static void test_upload_bsdf_sends_the_bytes(void **state)
{
    static const struct canned canned[] = {{"POST /v1/bsdfs", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char path[96];
    const char *const args[] = {"upload", "bsdf", path, "--server", f->url, NULL};

    cli_write_file(f->folder, "shade.xml", "<WindowElement/>");
    snprintf(path, sizeof path, "%s/shade.xml", f->folder);
    canned_run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_string_equal(canned_find(f, "POST /v1/bsdfs")->body, "<WindowElement/>");
}

static void test_upload_folder_finds_its_scene(void **state)
{
    static const struct canned canned[] = {{"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    const char *const args[] = {"upload", "scene", f->folder, "--server", f->url, NULL};
    const char *const list[] = {"upload", "scene", f->folder, "--list", NULL};

    cli_write_file(f->folder, "materials.rad", "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n");
    cli_write_file(f->folder, "room.rad",
                   "!xform -t 1 1 1 \\\n ./chair.rad\np sphere t\n0\n0\n4 9 0 0 1\n");
    cli_write_file(f->folder, "chair.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    cli_write_file(f->folder, "notes.txt", "not of the scene\n");
    canned_run_args(f, canned, list);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out,
                        "scene    materials.rad\nscene    room.rad\nresource chair.rad\n");
    canned_run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_null(strstr(canned_find(f, "POST /v1/scenes")->body, "notes.txt"));
}

static void test_upload_zip_sends_the_bytes(void **state)
{
    static const struct canned canned[] = {{"POST /v1/scenes", 201, "{\"id\": \"" SCENE_ID "\"}"},
                                           {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char path[96];
    const char *const args[] = {"upload", "scene",    path,   "b c.rad",
                                "a.rad",  "--server", f->url, NULL};

    cli_write_file(f->folder, "scene.zip", "PK");
    snprintf(path, sizeof path, "%s/scene.zip", f->folder);
    canned_run_args(f, canned, args);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, SCENE_ID "\n");
    assert_string_equal(canned_find(f, canned[0].request)->body, "PK");
}

#define BSDF_ID "18e347bfe032de96295acd358db2bd332ea8daab610bb2aa87a9eb7d21f4215b"
#define KNOWN_ID "5ba274fae42b925d7861240f35514e6583ede8c7090a3af09a298630fecceba3"

/* The command first asks the daemon by the digest of the upload. */
static void test_upload_skips_what_is_known(void **state)
{
    static const struct canned canned[] = {{"HEAD /v1/bsdfs/" BSDF_ID, 200, ""},
                                           {"HEAD /v1/scenes/" KNOWN_ID, 200, ""},
                                           {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    char path[96];
    const char *const bsdf[] = {"upload", "bsdf", path, "--server", f->url, NULL};
    const char *const scene[] = {"upload", "scene", f->folder, "--server", f->url, NULL};

    cli_write_file(f->folder, "shade.xml", "<WindowElement/>");
    snprintf(path, sizeof path, "%s/shade.xml", f->folder);
    canned_run_args(f, canned, bsdf);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, BSDF_ID "\n");
    cli_write_file(f->folder, "m.rad",
                   "void plastic p\n0\n0\n5 .5 .5 .5 0 0\n!xform ./chair.rad\n");
    cli_write_file(f->folder, "chair.rad", "p sphere s\n0\n0\n4 0 0 0 1\n");
    canned_run_args(f, canned, scene);
    assert_int_equal(f->result.exit_code, 0);
    assert_string_equal(f->result.out, KNOWN_ID "\n");
    canned_says(f->result.err, "already known");
    assert_int_equal(f->n_requests, 2);
}

static void test_removal(void **state)
{
    static const struct canned canned[] = {
        {"DELETE /v1/jobs/7", 204, ""},
        {"DELETE /v1/jobs/8", 409, "{\"title\": \"In use\", \"detail\": \"it runs\"}"},
        {"DELETE /v1/scenes/a", 204, ""},
        {"DELETE /v1/scenes/b", 204, ""},
        {"GET /v1/maps", 200,
         "{\"maps\": [{\"kind\": \"bsdf\", \"key\": \"01ab\"}, {\"kind\": \"global\", \"key\":"
         " \"01cd\"}]}"},
        {"DELETE /v1/maps/global/01cd", 204, ""},
        {NULL, 0, NULL}};
    struct canned_daemon *f = *state;
    const char *const scenes[] = {"remove", "scene", "a", "b", "--server", f->url, NULL};
    const char *const jobs[] = {"remove", "job", "7", "8", "--server", f->url, NULL};
    const char *const others[] = {"remove", "map", "x", NULL};
    const char *const one[] = {"maps", "--remove", "01c", "--server", f->url, NULL};
    const char *const two[] = {"maps", "--remove", "01", "--server", f->url, NULL};

    canned_run_args(f, canned, scenes);
    assert_int_equal(f->result.exit_code, 0);
    canned_run_args(f, canned, jobs);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "job 7: removed");
    canned_says(f->result.err, "8: it runs");
    canned_run_args(f, canned, others);
    assert_int_equal(f->result.exit_code, 2);
    canned_run_args(f, canned, one);
    assert_int_equal(f->result.exit_code, 0);
    assert_int_equal(canned_asked(f, "DELETE /v1/maps/global/01cd"), 1);
    canned_run_args(f, canned, two);
    assert_int_equal(f->result.exit_code, 1);
    canned_says(f->result.err, "more than one map");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, canned_set_up, canned_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_submit_sends_scene_references_and_sensors),
        TEST(test_submit_a_year_of_a_project),
        TEST(test_submit_finds_mistakes_before_sending),
        TEST(test_upload_bsdf_sends_the_bytes),
        TEST(test_upload_folder_finds_its_scene),
        TEST(test_upload_zip_sends_the_bytes),
        TEST(test_upload_skips_what_is_known),
        TEST(test_removal),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
