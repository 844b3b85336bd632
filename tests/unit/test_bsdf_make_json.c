/* Documents that request a panel's BSDF: decoded values, and refusals with their place. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "job/job_request_json.h"

static int read_job_request(const char *text, enum orl_job_origin origin,
                            struct orl_job_request *ret_task, char **ret_scene,
                            struct orl_error *err)
{
    json_t *doc = json_loads(text, 0, NULL);
    assert_non_null(doc);
    *err = (struct orl_error){0};
    const int code = orl_job_request_from_json(doc, origin, ret_task, ret_scene, err);
    json_decref(doc);
    return code;
}

#define SCENE "\"scene\": {\"files\": [\"a.rad\", \"b.rad\"]}"

static void it_says_what_is_made(void **state)
{
    struct orl_job_request job_request;
    struct orl_error err;
    size_t count;
    (void)state;
    assert_int_equal(
        read_job_request(
            "{\"kind\": \"bsdf_make\", " SCENE ", \"name\": \"P\", \"basis\": "
            "\"tensor_tree_4\", \"resolution\": 32, \"cull\": 0.1, \"cell\": {\"x\": [0, 1], "
            "\"y\": [-1, 2]}, \"symmetry\": \"both\", \"paths\": 64, \"accuracy\": 0.1, "
            "\"paths_most\": 128, \"seed\": 7, \"priority\": 3, \"tags\": [\"x\"]}",
            ORL_JOB_LOCAL, &job_request, NULL, &err),
        0);
    const struct orl_bsdf_make_request *r = &job_request.of.bsdf_make;
    assert_int_equal(job_request.kind, ORL_JOB_KIND_BSDF_MAKE);
    assert_int_equal(job_request.priority, 3);
    assert_string_equal(job_request.labels.name, "P");
    assert_string_equal(r->name, "P");
    assert_int_equal(r->basis, ORL_BSDF_TENSOR_TREE_4);
    assert_int_equal(r->symmetry, ORL_BSDF_QUADRILATERAL);
    assert_int_equal(r->resolution, 32);
    assert_true(r->cull == 0.1 && r->accuracy == 0.1 && r->has_cell);
    assert_true(r->cell[0] == 0 && r->cell[1] == 1 && r->cell[2] == -1 && r->cell[3] == 2);
    assert_int_equal(r->paths, 64);
    assert_int_equal(r->paths_most, 128);
    assert_int_equal(r->seed, 7);
    assert_string_equal(orl_job_request_scene(&job_request, &count)[1], "b.rad");
    assert_int_equal(count, 2);
    assert_null(orl_job_request_render_job(&job_request));
    orl_job_request_done(&job_request);
}

static void a_daemon_is_told_a_scene(void **state)
{
    struct orl_job_request job_request;
    struct orl_error err;
    char *scene = NULL;
    char text[160], id[65];
    size_t count;
    (void)state;
    memset(id, 'a', 64);
    id[64] = '\0';
    snprintf(text, sizeof text, "{\"kind\": \"bsdf_make\", \"scene\": \"%s\"}", id);
    assert_int_equal(read_job_request(text, ORL_JOB_REMOTE, &job_request, &scene, &err), 0);
    assert_string_equal(scene, id);
    orl_job_request_scene(&job_request, &count);
    assert_int_equal(count, 0);
    assert_int_equal(orl_bsdf_make_paths(&job_request.of.bsdf_make), 16384);
    orl_job_request_done(&job_request);
    free(scene);
}

static void what_is_wrong_is_told_by_its_place(void **state)
{
    static const struct {
        const char *member, *place;
        int code;
    } cases[] = {
        {"\"basis\": \"klems\"", "basis", ORL_ERR_INVALID},
        {"\"resolution\": 32", "resolution", ORL_ERR_INVALID},
        {"\"cull\": 0.1", "cull", ORL_ERR_INVALID},
        {"\"basis\": \"tensor_tree_4\", \"resolution\": 48", "resolution", ORL_ERR_RANGE},
        {"\"basis\": \"tensor_tree_4\", \"color\": 1", "color", ORL_ERR_INVALID},
        {"\"basis\": \"tensor_tree_3\", \"symmetry\": \"both\"", "symmetry", ORL_ERR_UNSUPPORTED},
        {"\"paths\": 15", "paths", ORL_ERR_RANGE},
        {"\"paths_most\": 64", "paths_most", ORL_ERR_INVALID},
        {"\"accuracy\": 0.1, \"paths\": 64, \"paths_most\": 32", "paths_most", ORL_ERR_RANGE},
        {"\"accuracy\": 1", "accuracy", ORL_ERR_RANGE},
        {"\"cell\": {\"x\": [0, 1]}", "cell", ORL_ERR_INVALID},
        {"\"cell\": {\"x\": [1, 0], \"y\": [0, 1]}", "cell.x", ORL_ERR_RANGE},
        {"\"cell\": {\"x\": [0], \"y\": [0, 1]}", "cell.x", ORL_ERR_INVALID},
        {"\"sensors\": []", "sensors", ORL_ERR_INVALID},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_job_request job_request;
        struct orl_error err;
        char text[256];
        snprintf(text, sizeof text, "{\"kind\": \"bsdf_make\", " SCENE ", %s}", cases[i].member);
        const int code = read_job_request(text, ORL_JOB_LOCAL, &job_request, NULL, &err);
        if (code != cases[i].code ||
            strncmp(err.primitive, cases[i].place, strlen(cases[i].place)) != 0)
            fail_msg("%s: %d, %s: %s", cases[i].member, code, err.primitive, err.message);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_says_what_is_made),
        cmocka_unit_test(a_daemon_is_told_a_scene),
        cmocka_unit_test(what_is_wrong_is_told_by_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
