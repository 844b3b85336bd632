/* Honeybee models and folders uploaded to a daemon: the content of the scene, and a job of its
 * grids. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/daemon.h"
#include "support/zip.h"

static char *read_model(void)
{
    json_t *model = json_load_file("tests/fixtures/honeybee/two_rooms.hbjson", 0, NULL);
    char *text = json_dumps(model, JSON_COMPACT);
    json_decref(model);
    assert_non_null(text);
    return text;
}

static void post_model(struct daemon *daemon, const char *query, const char *text,
                       struct reply *ret_reply)
{
    char path[128];
    snprintf(path, sizeof path, "/v1/scenes%s", query);
    daemon_request(daemon, "POST", path, "application/json", text, strlen(text), NULL, ret_reply);
}

static void expect_model(const struct reply *reply, const char *state)
{
    if (reply->status != 201)
        fail_msg("%ld %s", reply->status, reply->body);
    /* Faces, door, window, shades, mesh; and the second window. */
    assert_true(reply_number(reply, "summary.surfaces") >= 19);
    assert_string_equal(reply_text(reply, "summary.project.grids.0.name"), "desks");
    assert_string_equal(reply_text(reply, "summary.project.grids.1.sensors.file"),
                        "model/grid/store/floor.pts");
    assert_string_equal(reply_text(reply, "summary.project.views.0.name"), "from_door");
    assert_string_equal(reply_text(reply, "summary.project.states.south_glass.chosen"), state);
}

/* Runs the grids with the files that the summary names. */
static void run_grids(struct daemon *daemon, const char *scene, const json_t *grids)
{
    char *list = json_dumps(grids, JSON_COMPACT), *job = NULL, path[128], file[200];
    struct reply reply;
    assert_true(asprintf(&job,
                         "{\"kind\": \"render\", \"scene\": \"%s\", \"technique\": \"backward\","
                         " \"gather_samples\": 64, \"grids\": %s, \"sky\": {\"cie\": {\"type\":"
                         " \"overcast\", \"diffuse_horizontal_lx\": 10000}}}",
                         scene, list) > 0);
    daemon_post_json(daemon, "/v1/jobs", job, &reply);
    if (reply.status != 202)
        fail_msg("%ld %s", reply.status, reply.body);
    snprintf(path, sizeof path, "/v1/jobs/%s", reply_text(&reply, "id"));
    reply_done(&reply);
    daemon_wait(daemon, path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    snprintf(file, sizeof file, "%s/files/results/desks.res", path);
    daemon_get(daemon, file, &reply);
    if (reply.status != 200)
        fail_msg("%s: %ld %s", file, reply.status, reply.body);
    for (char *at = reply.body, *end; *at; at = end + 1) {
        assert_true(strtod(at, &end) > 10);
        assert_int_equal(*end, '\n');
    }
    reply_done(&reply);
    free(list);
    free(job);
}

static void test_a_model_becomes_a_scene(void **state)
{
    char *text = read_model(), first[65], second[65];
    struct reply reply;
    post_model(*state, "", text, &reply);
    expect_model(&reply, "0_south_glass");
    snprintf(first, sizeof first, "%s", reply_text(&reply, "id"));
    run_grids(*state, first, reply_at(&reply, "summary.project.grids"));
    reply_done(&reply);
    post_model(*state, "?state=south_glass%3D1_south_glass", text, &reply);
    expect_model(&reply, "1_south_glass");
    snprintf(second, sizeof second, "%s", reply_text(&reply, "id"));
    assert_string_not_equal(first, second);
    reply_done(&reply);
    free(text);
}

/* Two grids of one identifier. */
static void test_a_model_is_warned_of(void **state)
{
    char *text = read_model();
    json_t *model = json_loads(text, 0, NULL);
    json_t *radiance = json_object_get(json_object_get(model, "properties"), "radiance");
    json_t *grids = json_object_get(radiance, "sensor_grids");
    struct reply reply;
    free(text);
    json_array_append(grids, json_array_get(grids, 0));
    text = json_dumps(model, JSON_COMPACT);
    json_decref(model);
    post_model(*state, "", text, &reply);
    expect_model(&reply, "0_south_glass");
    assert_non_null(strstr(reply_text(&reply, "summary.project.warnings.0"),
                           "2 sensor grids of the model have this identifier"));
    reply_done(&reply);
    free(text);
}

static void expect_refusal(struct daemon *daemon, const char *query, const char *text,
                           const char *why)
{
    struct reply reply;
    post_model(daemon, query, text, &reply);
    if (reply.status != 422 && reply.status != 400)
        fail_msg("%ld %s", reply.status, reply.body);
    if (!strstr(reply.body, why))
        fail_msg("\"%s\" is not in: %s", why, reply.body);
    reply_done(&reply);
}

static void test_mistakes_are_told_by_their_place(void **state)
{
    char *text = read_model();
    expect_refusal(*state, "?state=south_glass%3Dclosed", text, "no state 'closed'");
    expect_refusal(*state, "?state=closed", text, "GROUP=STATE");
    expect_refusal(*state, "?sky=noon", text, "no sky 'noon'");
    expect_refusal(*state, "", "{\"type\": \"Model\", \"rooms\": [{\"faces\": [{}]}]}",
                   "rooms[0].faces[0]");
    expect_refusal(*state, "", "{\"type\": \"Model\"}", "the model is empty");
    free(text);
}

/* A weather file is uploaded with a model, and jobs of the scene name it. */
static void test_a_model_comes_with_files(void **state)
{
    char *model = read_model(), *text = NULL, *job = NULL;
    json_t *weather = json_string(
        "LOCATION,Here,-,-,made up,000000,38.42,27.14,2.0,25.0\nDESIGN CONDITIONS,0\n"
        "TYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\n"
        "COMMENTS 1,one hour\nCOMMENTS 2,\nDATA PERIODS,1,1,Data,Sunday,3/22,3/22\n"
        "2020,3,22,12,0,none,15,7,60,101300,9999,9999,300,600,500,200,999999,999999,99999\n");
    char *quoted = json_dumps(weather, JSON_ENCODE_ANY);
    struct reply reply;
    assert_true(asprintf(&text,
                         "{\"model\": %s, \"files\": [{\"name\": \"place.epw\", \"text\": %s}]}",
                         model, quoted) > 0);
    post_model(*state, "", text, &reply);
    expect_model(&reply, "0_south_glass");
    assert_true(asprintf(&job,
                         "{\"kind\": \"render\", \"scene\": \"%s\", \"technique\": \"backward\","
                         " \"gather_samples\": 64, \"sensors\": [[1, 1, 1, 0, 0, 1]], \"sky\":"
                         " {\"weather\": {\"file\": \"place.epw\", \"month\": 3, \"day\": 22,"
                         " \"hour\": 11.5}}}",
                         reply_text(&reply, "id")) > 0);
    reply_done(&reply);
    daemon_post_json(*state, "/v1/jobs", job, &reply);
    if (reply.status != 202)
        fail_msg("%ld %s", reply.status, reply.body);
    reply_done(&reply);
    expect_refusal(*state, "", "{\"model\": {\"type\": \"Room\"}}", "this is not a Honeybee model");
    expect_refusal(*state, "", "{\"model\": {\"type\": \"Model\"}, \"weather\": 1}", "weather");
    json_decref(weather);
    free(quoted);
    free(model);
    free(text);
    free(job);
}

/* A web form uploads a model and its weather as parts. */
static void test_a_model_comes_in_a_form(void **state)
{
    static const char *const names[] = {"office.hbjson", "office.json"};
    char *model = read_model();
    struct reply reply;
    for (int i = 0; i < 2; i++) {
        const struct upload_file files[] = {{names[i], model, strlen(model), false},
                                            {"place.epw", "LOCATION,Here", 13, i == 1}};
        daemon_upload(*state, files, 2, NULL, &reply);
        assert_int_equal(reply.status, i == 0 ? 201 : 200);
        assert_string_equal(reply_text(&reply, "summary.project.grids.0.name"), "desks");
        assert_string_equal(reply_text(&reply, "summary.project.states.south_glass.chosen"),
                            "0_south_glass");
        reply_done(&reply);
    }
    const struct upload_file bad[] = {{"bad.hbjson", "{\"type\": \"Model\"}", 17, false}};
    daemon_upload(*state, bad, 1, NULL, &reply);
    assert_true(reply.status == 422 || reply.status == 400);
    assert_string_equal(reply_text(&reply, "file"), "bad.hbjson");
    assert_non_null(strstr(reply_text(&reply, "detail"), "the model is empty"));
    reply_done(&reply);
    free(model);
}

static bool is_unread(const struct reply *reply, const char *name)
{
    bool found = false;
    for (int i = 0; i < 16 && !found; i++) {
        char path[32];
        snprintf(path, sizeof path, "summary.unread.%d", i);
        found = strcmp(reply_text(reply, path), name) == 0;
    }
    return found;
}

/* A file that describes a scene but is not read causes a message. */
static void test_files_beside_a_model(void **state)
{
    static const char rad[] = "void plastic grey\n0\n0\n5 0.4 0.4 0.4 0 0\n";
    char *model = read_model();
    struct reply reply;
    const struct upload_file two[] = {{"a.hbjson", model, strlen(model), false},
                                      {"b.HBJSON", model, strlen(model), false}};
    daemon_upload(*state, two, 2, NULL, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "file"), "b.HBJSON");
    assert_non_null(strstr(reply_text(&reply, "detail"), "'a.hbjson' came before"));
    reply_done(&reply);
    const struct upload_file more[] = {{"a.hbjson", model, strlen(model), false},
                                       {"b.hbjson", model, strlen(model), true},
                                       {"room.rad", rad, strlen(rad), false}};
    daemon_upload(*state, more, 3, NULL, &reply);
    assert_int_equal(reply.status, 201);
    assert_true(is_unread(&reply, "b.hbjson"));
    assert_true(is_unread(&reply, "room.rad"));
    reply_done(&reply);
    free(model);
}

/* Models in a zip of Radiance files are not part of the scene, and the reply states this. */
static void test_models_in_a_zip(void **state)
{
    static const char rad[] =
        "void plastic grey\n0\n0\n5 0.4 0.4 0.4 0 0\ngrey sphere ball\n0\n0\n4 1 1 1 0.4\n";
    const struct zip_entry entries[] = {ZIP_TEXT("a.hbjson", "{}"), ZIP_TEXT("b.hbjson", "{}"),
                                        ZIP_TEXT("ball.rad", rad)};
    size_t size;
    struct reply reply;
    char *zip = zip_make(entries, 3, &size);
    daemon_request(*state, "POST", "/v1/scenes", "application/zip", zip, size, NULL, &reply);
    assert_int_equal(reply.status, 201);
    assert_string_equal(reply_text(&reply, "summary.unread.0"), "a.hbjson");
    assert_string_equal(reply_text(&reply, "summary.unread.1"), "b.hbjson");
    reply_done(&reply);
    free(zip);
}

/* The folder's own name is kept: its texts say model/bsdf/NAME.xml. */
static void test_a_folder_comes_as_a_zip(void **state)
{
    static const char mat[] = "void plastic white\n0\n0\n5 0.7 0.7 0.7 0 0\n";
    static const char rad[] = "white polygon floor\n0\n0\n12 0 0 0 1 0 0 1 1 0 0 1 0\n";
    static const char sky[] = "void glow g\n0\n0\n4 1 1 1 0\ng source sky\n0\n0\n4 0 0 1 180\n";
    const struct zip_entry entries[] = {
        ZIP_TEXT("model/scene/a.rad", rad),  ZIP_TEXT("model/scene/z.mat", mat),
        ZIP_TEXT("model/scene/z.blk", mat),  ZIP_TEXT("model/grid/a b.pts", "0 0 1 0 0 1\n"),
        ZIP_TEXT("model/sky/noon.rad", sky), ZIP_TEXT("model/sky/dusk.rad", sky)};
    size_t size;
    struct reply reply;
    char *zip = zip_make(entries, sizeof entries / sizeof *entries, &size);
    daemon_request(*state, "POST", "/v1/scenes?sky=dusk", "application/zip", zip, size, NULL,
                   &reply);
    if (reply.status != 201)
        fail_msg("%ld %s", reply.status, reply.body);
    assert_true(reply_number(&reply, "summary.sources") == 1);
    assert_string_equal(reply_text(&reply, "summary.project.grids.0.name"), "a_b");
    assert_string_equal(reply_text(&reply, "summary.project.grids.0.sensors.file"),
                        "model/grid/a b.pts");
    assert_string_equal(reply_text(&reply, "summary.project.left_out.0.file"), "model/scene/z.blk");
    reply_done(&reply);
    free(zip);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_model_becomes_a_scene),
        cmocka_unit_test(test_a_model_is_warned_of),
        cmocka_unit_test(test_mistakes_are_told_by_their_place),
        cmocka_unit_test(test_a_model_comes_with_files),
        cmocka_unit_test(test_a_model_comes_in_a_form),
        cmocka_unit_test(test_files_beside_a_model),
        cmocka_unit_test(test_models_in_a_zip),
        cmocka_unit_test(test_a_folder_comes_as_a_zip),
    };
    return cmocka_run_group_tests(tests, daemon_set_up, daemon_tear_down);
}
