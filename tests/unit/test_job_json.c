/* Job documents: what decodes, and what each mistake is told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "decode.h"
#include "job_json.h"

#define ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

static int decode(const char *text, enum orl_job_origin origin, struct orl_job *job, char **id,
                  struct orl_error *err)
{
    json_t *doc = NULL;
    int rc = orl_json_parse("job.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_job_from_json(doc, origin, job, id, err);
    json_decref(doc);
    return rc;
}

static void test_full_remote_document(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    const int rc =
        decode("{\"kind\":\"render\",\"scene\":\"" ID "\",\"technique\":\"gather\",\"seed\":7,"
               "\"photons\":{\"global\":2e5,\"caustic\":0},\"gather_samples\":64,"
               "\"sensors\":[[1,2,3,0,0,1],[4.5,5,6,1,0,0]],"
               "\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":4,\"height\":3}]}",
               ORL_JOB_REMOTE, &job, &id, &err);
    assert_int_equal(rc, 0);
    assert_string_equal(id, ID);
    assert_int_equal(job.seed, 7);
    assert_int_equal(job.photons_global, 200000);
    assert_int_equal(job.photons_caustic, 0);
    assert_int_equal(job.gather_samples, 64);
    assert_int_equal(job.n_sensors, 2);
    assert_true(job.sensors[1].position.x == 4.5 && job.sensors[1].direction.x == 1);
    assert_int_equal(job.n_views, 1);
    assert_string_equal(job.views[0].view, "-vtv");
    assert_int_equal(job.views[0].width, 4);
    assert_int_equal(job.n_scene_files, 0);
    orl_job_done(&job);
    free(id);
}

static void test_local_document_and_defaults(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = (char *)"untouched?";
    assert_int_equal(decode("{\"scene\":{\"files\":[\"a.rad\",\"b.rad\"]},"
                            "\"sensors\":{\"file\":\"s.txt\"}}",
                            ORL_JOB_LOCAL, &job, &id, &err),
                     0);
    assert_null(id);
    assert_int_equal(job.n_scene_files, 2);
    assert_string_equal(job.scene_files[1], "b.rad");
    assert_string_equal(job.sensors_file, "s.txt");
    assert_int_equal(job.photons_global, ORL_DEFAULT_PHOTONS);
    assert_int_equal(job.photons_caustic, ORL_DEFAULT_PHOTONS);
    assert_int_equal(job.seed, 1);
    orl_job_done(&job);
}

/* Each mistake: the document (without braces), the code, and the JSON path it must name. */
static const struct {
    const char *text;
    int code;
    const char *path;
} mistakes[] = {
    {"", ORL_ERR_INVALID, "scene"},
    {"\"scene\":7", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"0123\"", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"0123456789ABCDEF0123456789abcdef0123456789abcdef0123456789abcdef\"",
     ORL_ERR_INVALID, "scene"},
    {"\"scene\":{\"files\":[\"a.rad\"]}", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"" ID "\"", ORL_ERR_INVALID, "document"},
    {"\"scene\":\"" ID "\",\"sensors\":[],\"views\":[]", ORL_ERR_INVALID, "document"},
    {"\"scene\":\"" ID "\",\"sensor\":[]", ORL_ERR_INVALID, "sensor"},
    {"\"scene\":\"" ID "\",\"kind\":\"annual\"", ORL_ERR_INVALID, "kind"},
    {"\"scene\":\"" ID "\",\"technique\":1", ORL_ERR_INVALID, "technique"},
    {"\"scene\":\"" ID "\",\"photons\":{\"globl\":1}", ORL_ERR_INVALID, "photons.globl"},
    {"\"scene\":\"" ID "\",\"photons\":[]", ORL_ERR_INVALID, "photons"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":0}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":-5}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":1.5}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"caustic\":1e300}", ORL_ERR_RANGE, "photons.caustic"},
    {"\"scene\":\"" ID "\",\"photons\":{\"caustic\":\"many\"}", ORL_ERR_INVALID, "photons.caustic"},
    {"\"scene\":\"" ID "\",\"seed\":-1", ORL_ERR_RANGE, "seed"},
    {"\"scene\":\"" ID "\",\"gather_samples\":null", ORL_ERR_INVALID, "gather_samples"},
    {"\"scene\":\"" ID "\",\"sensors\":7", ORL_ERR_INVALID, "sensors"},
    {"\"scene\":\"" ID "\",\"sensors\":{\"file\":\"\"}", ORL_ERR_INVALID, "sensors.file"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,1],[1,2,3]]", ORL_ERR_INVALID, "sensors[1]"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,true]]", ORL_ERR_INVALID, "sensors[0][5]"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,0]]", ORL_ERR_RANGE, "sensors[0]"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":1}]",
     ORL_ERR_INVALID, "views[0].height"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":99999,"
     "\"height\":1}]",
     ORL_ERR_RANGE, "views[0].width"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"\",\"view\":\"-vtv\",\"width\":1,"
     "\"height\":1}]",
     ORL_ERR_INVALID, "views[0].name"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"\",\"width\":1,\"height\":1},7]",
     ORL_ERR_INVALID, "views[0].view"},
};

static void test_mistakes_name_their_path(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        char text[1024];
        struct orl_job job;
        struct orl_error err;
        char *id = NULL;
        snprintf(text, sizeof text, "{%s}", mistakes[i].text);
        const int rc = decode(text, ORL_JOB_REMOTE, &job, &id, &err);
        if (rc != mistakes[i].code || strcmp(err.primitive, mistakes[i].path) != 0)
            fail_msg("%s: code %d at '%s', expected %d at '%s'", text, rc, err.primitive,
                     mistakes[i].code, mistakes[i].path);
        assert_non_null(strstr(err.message, mistakes[i].path));
        assert_null(id);
    }
}

static void test_unknown_member_lists_the_known(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    decode("{\"scene\":\"" ID "\",\"photons\":{\"globl\":1}}", ORL_JOB_REMOTE, &job, &id, &err);
    assert_string_equal(err.hint, "Known here: global, caustic");
}

/* What is not JSON at all, or not JSON as we want it. */
static void test_syntax_has_a_line(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int line;
    } bad[] = {
        {"", 1},
        {"{\n\"scene\":}", 2},
        {"{\"seed\":NaN}", 1},
        {"{\"seed\":1,\n\"seed\":2}", 2},
        {"{\"seed\":1e999}", 1},
        {"[1,2", 1},
        {"{\"scene\":\"\xff\"}", 1},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct orl_error err;
        json_t *doc = NULL;
        assert_int_equal(orl_json_parse("job.json", bad[i].text, strlen(bad[i].text), &doc, &err),
                         ORL_ERR_SYNTAX);
        assert_null(doc);
        assert_int_equal(err.line, bad[i].line);
        assert_string_equal(err.file, "job.json");
    }
}

/* An array or a bare word where the document should be. */
static void test_document_must_be_an_object(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    assert_int_equal(decode("[]", ORL_JOB_REMOTE, &job, &id, &err), ORL_ERR_INVALID);
    assert_string_equal(err.primitive, "document");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_full_remote_document),
        cmocka_unit_test(test_local_document_and_defaults),
        cmocka_unit_test(test_mistakes_name_their_path),
        cmocka_unit_test(test_unknown_member_lists_the_known),
        cmocka_unit_test(test_syntax_has_a_line),
        cmocka_unit_test(test_document_must_be_an_object),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
