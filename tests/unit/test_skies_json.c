/* Several skies in job documents: lists, sequences of hours, and errors. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "job/job_json.h"
#include "result/result_json.h"
#include "json/decode.h"

static int decode(const char *skies, struct orl_job *job, struct orl_error *err)
{
    char text[2048];
    json_t *doc = NULL;
    snprintf(text, sizeof text,
             "{\"scene\":{\"files\":[\"a.rad\"]},\"sensors\":[[0,0,1,0,0,1]],\"skies\":%s}", skies);
    int rc = orl_json_parse("job.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_job_from_json(doc, ORL_JOB_LOCAL, job, NULL, err);
    json_decref(doc);
    if (rc == 0)
        rc = orl_job_validate(job, err);
    return rc;
}

static void test_list(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    const int rc = decode("[{\"name\":\"grey\",\"cie\":{\"type\":\"overcast\","
                          "\"diffuse_horizontal_lx\":9000}},"
                          "{\"weather\":{\"file\":\"a.epw\",\"month\":3,\"day\":22,\"hour\":11.5}},"
                          "{\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":100}}]",
                          &job, &err);
    if (rc)
        fail_msg("%s", err.message);
    assert_int_equal(job.n_skies, 3);
    assert_string_equal(job.skies[0].name, "grey");
    assert_string_equal(job.skies[1].name, "0322-1130");
    assert_string_equal(job.skies[2].name, "sky-0002");
    assert_int_equal(job.skies[0].request.model, ORL_SKY_BY_CIE);
    assert_string_equal(job.skies[1].request.weather_file, "a.epw");
    assert_true(job.skies[2].request.first == 100);
    orl_job_done(&job);
}

/* Sequences across midnight and the end of February; the last step is included. */
static void test_hours(void **state)
{
    (void)state;
    static const char *const names[] = {"0228-2230", "0228-2330", "0301-0030", "0301-0130"};
    struct orl_job job;
    int rc = decode("{\"weather\":{\"file\":\"a.epw\",\"year\":2021},\"normalise\":\"gendaylit\","
                    "\"sun\":\"radiance\",\"from\":{\"month\":2,\"day\":28,\"hour\":22.5},"
                    "\"to\":{\"month\":3,\"day\":1,\"hour\":1.5}}",
                    &job, NULL);
    assert_int_equal(rc, 0);
    assert_int_equal(job.n_skies, 4);
    for (size_t i = 0; i < 4; i++) {
        const struct orl_sky_request *r = &job.skies[i].request;
        assert_string_equal(job.skies[i].name, names[i]);
        assert_int_equal(r->normalise, ORL_SKY_GENDAYLIT);
        assert_int_equal(r->weather_year, 2021);
        assert_int_equal(r->sun_method, ORL_SUN_RADIANCE);
        assert_int_equal(r->month, i < 2 ? 2 : 3);
        assert_int_equal(r->day, i < 2 ? 28 : 1);
        assert_true(r->hour == fmod(22.5 + (double)i, 24));
    }
    orl_job_done(&job);
}

/* Steps without an exact binary fraction end where they should, and hours stay below 24. */
static void test_steps(void **state)
{
    (void)state;
    struct orl_job job;
    int rc =
        decode("{\"cie\":{\"type\":\"clear\",\"latitude\":38,\"longitude\":27,\"time_zone\":2},"
               "\"from\":{\"month\":12,\"day\":30,\"hour\":0},"
               "\"to\":{\"month\":12,\"day\":31,\"hour\":23.9},\"step_h\":0.1}",
               &job, NULL);
    assert_int_equal(rc, 0);
    assert_int_equal(job.n_skies, 480);
    assert_string_equal(job.skies[3].name, "1230-0018");
    assert_true(job.skies[3].request.hour == 0.3);
    assert_string_equal(job.skies[240].name, "1231-0000");
    assert_true(job.skies[240].request.hour == 0);
    assert_string_equal(job.skies[479].name, "1231-2354");
    orl_job_done(&job);
}

#define FROM_TO                                                                                    \
    ",\"from\":{\"month\":3,\"day\":22,\"hour\":9},\"to\":{\"month\":3,\"day\":22,\"hour\":15}"

static void test_mistakes(void **state)
{
    (void)state;
    static const struct {
        const char *skies, *primitive;
        int code;
    } cases[] = {
        {"7", "skies", ORL_ERR_INVALID},
        {"[]", "skies", ORL_ERR_INVALID},
        {"[7]", "skies[0]", ORL_ERR_INVALID},
        {"[{\"name\":\"a\"}]", "skies[0]", ORL_ERR_INVALID},
        {"[{\"name\":7,\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":1}}]",
         "skies[0].name", ORL_ERR_INVALID},
        {"[{\"name\":\"a.b\",\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":1}}]",
         "skies[0]", ORL_ERR_INVALID},
        {"[{\"name\":\"result\",\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":1}}]",
         "skies[0]", ORL_ERR_INVALID},
        {"[{\"weather\":{\"file\":\"a.epw\",\"month\":13,\"day\":22,\"hour\":11.5}}]",
         "skies[0].weather.month", ORL_ERR_RANGE},
        {"[{\"weather\":{\"file\":\"a.epw\",\"month\":3,\"day\":22,\"hour\":9}},"
         "{\"weather\":{\"file\":\"b.epw\",\"month\":3,\"day\":22,\"hour\":9}}]",
         "skies[1]", ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\"}}", "skies.from", ORL_ERR_INVALID},
        {"{\"weather\":7" FROM_TO "}", "skies", ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\",\"hour\":3}" FROM_TO "}", "skies", ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\"},\"cie\":{}" FROM_TO "}", "skies", ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\"},\"every\":1" FROM_TO "}", "skies.every",
         ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\"},\"step_h\":0" FROM_TO "}", "skies.step_h",
         ORL_ERR_RANGE},
        {"{\"weather\":{\"file\":\"a.epw\"},\"step_h\":1e300" FROM_TO "}", "skies.step_h",
         ORL_ERR_RANGE},
        {"{\"weather\":{\"file\":\"a.epw\"},\"from\":{\"month\":2,\"day\":29,\"hour\":0},\"to\":{}"
         "}",
         "skies.from.day", ORL_ERR_RANGE},
        {"{\"weather\":{\"file\":\"a.epw\"},\"from\":{\"month\":3,\"day\":22,\"hour\":24}}",
         "skies.from.hour", ORL_ERR_RANGE},
        {"{\"weather\":{\"file\":\"a.epw\"},\"from\":{\"month\":3,\"day\":22,\"hour\":9},"
         "\"to\":{\"month\":3,\"day\":22,\"hour\":8}}",
         "skies.to", ORL_ERR_INVALID},
        {"{\"weather\":{\"file\":\"a.epw\"},\"from\":{\"month\":1,\"day\":1,\"hour\":0},"
         "\"to\":{\"month\":12,\"day\":31,\"hour\":23}}",
         "skies", ORL_ERR_LIMIT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_job job = {0};
        struct orl_error err = {0};
        const int rc = decode(cases[i].skies, &job, &err);
        orl_job_done(&job);
        if (rc != cases[i].code || strcmp(err.primitive, cases[i].primitive) != 0)
            fail_msg("%s: %d %s: %s", cases[i].skies, rc, err.primitive, err.message);
    }
}

/* Combined results of several skies: sums, names and warnings. */
static void test_results(void **state)
{
    (void)state;
    double lx[] = {1.5, 2.5};
    char *warnings[] = {"the same"};
    struct orl_result result = {.threads = 2,
                                .plan = {.technique = ORL_TECHNIQUE_GATHER},
                                .timings_s = {1, 2},
                                .total_s = 4,
                                .illuminance_lx = lx,
                                .n_sensors = 2,
                                .sky_given = true,
                                .warnings = warnings,
                                .n_warnings = 1};
    json_t *all = orl_skies_result_new(7, 2);
    for (int i = 0; i < 2; i++) {
        json_t *one = orl_sky_result_to_json(&result, i ? "b" : "a");
        assert_string_equal(json_string_value(json_object_get(one, "sky")), i ? "b" : "a");
        assert_int_equal(orl_skies_result_add(all, one), 0);
        json_decref(one);
        result.sky_dark = true;
    }
    assert_int_equal(orl_skies_result_end(all, "succeeded"), 0);
    json_t *expected = json_pack(
        "{s:s, s:i, s:i, s:{s:f, s:f, s:f, s:f, s:f, s:f, s:f}, s:[s], s:[{s:s, s:s, s:b, s:s, "
        "s:f, s:[f, f], s:[]}, {s:s, s:s, s:b, s:s, s:f, s:[f, f], s:[]}]}",
        "state", "succeeded", "threads", 2, "seed", 7, "timings_s", "load", 2.0, "bvh", 4.0, "plan",
        0.0, "photons", 0.0, "maps", 0.0, "render", 0.0, "total", 8.0, "warnings", "the same",
        "skies", "name", "a", "file", "a.json", "dark", 0, "technique", "gather", "seconds", 4.0,
        "illuminance_lx", 1.5, 2.5, "views", "name", "b", "file", "b.json", "dark", 1, "technique",
        "gather", "seconds", 4.0, "illuminance_lx", 1.5, 2.5, "views");
    assert_non_null(expected);
    assert_true(json_equal(all, expected));
    json_decref(all);
    json_decref(expected);
}

/* ---- Sequences of pictures --------------------------------------------------------------------
 */

static int decode_sequence(const char *more, struct orl_job *job, struct orl_error *err)
{
    char text[1024];
    json_t *doc;
    snprintf(text, sizeof text,
             "{\"scene\":{\"files\":[\"a.rad\"]},\"views\":[{\"name\":\"v\",\"view\":\"-vtv\","
             "\"width\":8,"
             "\"height\":8%s}",
             more);
    assert_int_equal(orl_json_parse(NULL, text, strlen(text), &doc, NULL), 0);
    int rc = orl_job_from_json(doc, ORL_JOB_LOCAL, job, NULL, err);
    if (rc == 0 && (rc = orl_job_validate(job, err)) < 0)
        orl_job_done(job);
    json_decref(doc);
    return rc;
}

#define GREY "{\"name\":\"grey\",\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":1000}}"

static void test_sequence(void **state)
{
    static const struct {
        const char *more;
        int code;
    } cases[] = {
        {"}],\"skies\":[" GREY "],\"sequence\":{}", 0},
        {",\"formats\":[\"hdr\",\"exr\"]}],\"skies\":[" GREY "],\"sequence\":{\"columns\":64}", 0},
        {"}],\"sequence\":{}", ORL_ERR_INVALID},
        {",\"formats\":[\"png\"]}],\"skies\":[" GREY "],\"sequence\":{}", ORL_ERR_INVALID},
        {"}],\"skies\":[{\"name\":\"sequence\",\"cie\":{\"type\":\"overcast\","
         "\"diffuse_horizontal_lx\":1000}}],\"sequence\":{}",
         ORL_ERR_INVALID},
        {"}],\"skies\":[" GREY "],\"sequence\":7", ORL_ERR_INVALID},
        {"}],\"skies\":[" GREY "],\"sequence\":{\"speed\":7}", ORL_ERR_INVALID},
        {"}],\"skies\":[" GREY "],\"sequence\":{\"frame_s\":0}", ORL_ERR_RANGE},
        {"}],\"skies\":[" GREY "],\"sequence\":{\"columns\":65}", ORL_ERR_RANGE},
        {"}],\"skies\":[" GREY "],\"sequence\":{\"picture_width\":15}", ORL_ERR_RANGE},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_job job;
        struct orl_error err = {0};
        const int code = decode_sequence(cases[i].more, &job, &err);
        if (code != cases[i].code)
            fail_msg("%s: %d %s", cases[i].more, code, err.message);
        if (code == 0)
            orl_job_done(&job);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_list),    cmocka_unit_test(test_hours),
        cmocka_unit_test(test_steps),   cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_results), cmocka_unit_test(test_sequence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
