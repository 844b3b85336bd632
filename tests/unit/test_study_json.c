/* Study documents: decoded values, refusals and their messages, and results. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "job/study_json.h"
#include "support/study_data.h"
#include "json/decode.h"

static const char good[] =
    "{\"kind\": \"study\", \"title\": \"A room\", \"note\": \"Made up.\", \"scene\": {\"files\": "
    "[\"room.rad\"]},"
    " \"seed\": 5, \"effects\": {\"caustics\": \"skip\"}, \"sensors\": [[1, 2, 0.8, 0, 0, 1]],"
    " \"techniques\": [\"backward\", \"direct\"], \"photons\": [1e4, 20000],"
    " \"gather_samples\": [64], \"repeats\": 2, \"reference\": {\"samples\": 512, \"runs\": 4},"
    " \"points\": [{\"name\": \"By hand\", \"seconds\": 3600, \"rms\": 0.5}]}";

/* Reads and checks a document, as the command does. */
static int read_study(const char *text, struct orl_study_request *ret_request,
                      struct orl_error *err)
{
    json_t *doc = NULL;
    int rc = orl_json_parse("study.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_study_from_json(doc, ORL_JOB_LOCAL, ret_request, NULL, err);
    json_decref(doc);
    if (rc)
        return rc;
    rc = orl_study_request_validate(ret_request, err);
    if (rc)
        orl_study_request_done(ret_request);
    return rc;
}

static void test_a_whole_document(void **state)
{
    struct orl_study_request r;
    (void)state;
    assert_int_equal(read_study(good, &r, NULL), 0);
    assert_string_equal(r.title, "A room");
    assert_string_equal(r.note, "Made up.");
    assert_string_equal(r.job.scene_files[0], "room.rad");
    assert_int_equal(r.job.seed, 5);
    assert_int_equal(r.job.n_sensors, 1);
    assert_int_equal(r.job.overrides[ORL_EFFECT_CAUSTICS_BSDF], ORL_OVERRIDE_SKIP);
    assert_int_equal(r.n_techniques, 2);
    assert_int_equal(r.techniques[1], ORL_TECHNIQUE_DIRECT);
    assert_int_equal(r.n_photons, 2);
    assert_int_equal(r.photons[0], 10000);
    assert_int_equal(r.n_samples, 1);
    assert_int_equal(r.samples[0], 64);
    assert_int_equal(r.repeats, 2);
    assert_int_equal(r.reference_samples, 512);
    assert_int_equal(r.reference_runs, 4);
    assert_int_equal(r.n_external, 1);
    assert_string_equal(r.external[0].name, "By hand");
    assert_true(r.external[0].seconds > 3599 && r.external[0].rms < 0.51);
    orl_study_request_done(&r);
}

/* Returns the document with the first `from` in it replaced. */
static void change(const char *from, const char *to, char ret_text[2048])
{
    const char *at = strstr(good, from);
    assert_non_null(at);
    snprintf(ret_text, 2048, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
}

static void test_mistakes_are_named(void **state)
{
    static const struct {
        const char *from, *to, *says;
        int code;
    } cases[] = {
        {"\"study\"", "\"render\"", "\"kind\": \"study\"", ORL_ERR_INVALID},
        {"\"repeats\"", "\"repeat\"", "repeat: there is no such member", ORL_ERR_INVALID},
        {"\"scene\": {\"files\": [\"room.rad\"]},", "", "scene: ", ORL_ERR_INVALID},
        {"\"direct\"", "\"auto\"", "techniques[1]: ", ORL_ERR_INVALID},
        {"\"direct\"", "3", "techniques[1]: ", ORL_ERR_INVALID},
        {"\"direct\"", "\"backward\"", "\"backward\" is named twice", ORL_ERR_INVALID},
        {"[\"backward\", \"direct\"]", "[]", "techniques: the list is empty", ORL_ERR_INVALID},
        {"\"photons\": [1e4, 20000],", "", "\"direct\" needs a list of photons", ORL_ERR_INVALID},
        {"\"gather_samples\": [64],", "", "\"backward\" needs a list of samples", ORL_ERR_INVALID},
        {"[1e4, 20000]", "[0]", "photons[0]: a whole number", ORL_ERR_RANGE},
        {"[1e4, 20000]", "20000", "photons: an array", ORL_ERR_INVALID},
        {"\"gather_samples\"", "\"pixel_samples\"", "pixel_samples: the study measures sensors",
         ORL_ERR_INVALID},
        {"[64]", "[6.5]", "gather_samples[0]: a whole number", ORL_ERR_RANGE},
        {"\"repeats\": 2", "\"repeats\": 0", "repeats: a whole number", ORL_ERR_RANGE},
        {"\"repeats\": 2", "\"repeats\": 1000", "more than 2000 runs", ORL_ERR_LIMIT},
        {", \"reference\": {\"samples\": 512, \"runs\": 4}", "", "reference: an object",
         ORL_ERR_INVALID},
        {"{\"samples\": 512, \"runs\": 4}", "{\"seed\": 512}", "reference.seed: ", ORL_ERR_INVALID},
        {"3600", "0", "points[0].seconds: it must be from 1e-12", ORL_ERR_RANGE},
        {"0.5}", "\"5 %\"}", "points[0].rms: a number is expected", ORL_ERR_INVALID},
        {"0.5}", "0.5, \"rays_per_s\": -1}", "points[0].rays_per_s: it must be from 1e-12",
         ORL_ERR_RANGE},
        {"\"name\"", "\"label\"", "points[0].label: ", ORL_ERR_INVALID},
        {"\"By hand\"", "\"\"", "points[0].name: the string is empty", ORL_ERR_INVALID},
        {"\"sensors\": [[1, 2, 0.8, 0, 0, 1]],", "", "requests no results", ORL_ERR_INVALID},
        {"\"sensors\": [[1, 2, 0.8, 0, 0, 1]],",
         "\"sensors\": {\"file\": \"s.txt\"}, \"views\": [{\"name\": \"v\", \"view\": \"-vtv\", "
         "\"width\": 8, \"height\": 8}],",
         "gather_samples: the study measures views", ORL_ERR_INVALID},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_study_request r;
        struct orl_error err = {0};
        char text[2048];
        change(cases[i].from, cases[i].to, text);
        const int code = read_study(text, &r, &err);
        if (code != cases[i].code || !strstr(err.message, cases[i].says))
            fail_msg("%s instead of %s: %d, %s", cases[i].to, cases[i].from, code, err.message);
    }
}

static void test_sensors_and_views_are_not_mixed(void **state)
{
    struct orl_study_request r;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(
        read_study("{\"kind\": \"study\", \"scene\": {\"files\": [\"a.rad\"]}, \"sensors\":"
                   " [[1, 2, 1, 0, 0, 1]], \"views\": [{\"name\": \"v\", \"view\": \"-vtv\","
                   " \"width\": 8, \"height\": 8}], \"techniques\": [\"gather\"], \"photons\":"
                   " [1000], \"reference\": {\"samples\": 64}}",
                   &r, &err),
        ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "either sensors or views, not both"));
}

/* Every point and name is written, and unknown values are null. */
static void test_results(void **state)
{
    struct orl_study study = study_of_chance(1, 3, 2);
    (void)state;
    study.points[0].peak = NAN;
    study.points[1].setting.photons = 0;
    char title[] = "A room";
    const struct orl_study_request request = {.title = title};
    json_t *json = orl_study_to_json(&study, &request);
    assert_non_null(json);
    const json_t *points = json_object_get(json, "points");
    assert_int_equal(json_array_size(points), study.n_points);
    for (size_t i = 0; i < study.n_points; i++) {
        const json_t *p = json_array_get(points, i);
        assert_string_equal(json_string_value(json_object_get(p, "technique")),
                            orl_technique_name(study.points[i].setting.technique));
        assert_true(json_number_value(json_object_get(p, "rms")) == study.points[i].rms);
        assert_int_equal(json_is_true(json_object_get(p, "on_front")), study.points[i].on_front);
        assert_true(json_number_value(json_object_get(json_object_get(p, "seconds"), "total")) ==
                    study.points[i].total_s);
    }
    assert_true(json_is_null(json_object_get(json_array_get(points, 0), "peak")));
    assert_true(json_is_null(json_object_get(json_array_get(points, 1), "photons")));
    assert_int_equal(json_array_size(json_object_get(json, "given")), 2);
    assert_string_equal(json_string_value(json_object_get(json, "measured")), "sensors");
    assert_string_equal(json_string_value(json_object_get(json, "title")), title);
    assert_true(json_is_null(json_object_get(json, "note")));
    json_decref(json);
    orl_study_done(&study);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_whole_document),
        cmocka_unit_test(test_mistakes_are_named),
        cmocka_unit_test(test_sensors_and_views_are_not_mixed),
        cmocka_unit_test(test_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
