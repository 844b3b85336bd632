/* Documents that request a BSDF fit of measurements: decoded values, and refusals with their
 * place. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bsdf_json/bsdf_json.h"

static int read_document(const char *text, enum orl_job_origin origin,
                         struct orl_bsdf_fit_request *ret_request, char **ret_id,
                         struct orl_error *err)
{
    json_t *doc = json_loads(text, 0, NULL);
    assert_non_null(doc);
    *err = (struct orl_error){0};
    const int code = orl_bsdf_fit_from_json(doc, origin, ret_request, ret_id, err);
    json_decref(doc);
    return code;
}

#define KIND "\"kind\": \"bsdf_fit\", "
#define DATA "\"measurements\": {\"files\": [\"a.txt\", \"b.csv\"]}"

static void it_says_what_is_fitted(void **state)
{
    struct orl_bsdf_fit_request r;
    struct orl_error err;
    (void)state;
    assert_int_equal(
        read_document("{" KIND DATA ", \"name\": \"P\", \"basis\": \"tensor_tree_4\", "
                      "\"symmetry\": \"half_turn\", \"resolution\": 32, \"cull\": 0.1, "
                      "\"reversed\": true, \"keep_outliers\": true, \"grazing\": 2.5}",
                      ORL_JOB_LOCAL, &r, NULL, &err),
        0);
    assert_int_equal(r.n_files, 2);
    assert_string_equal(r.files[1], "b.csv");
    assert_string_equal(r.name, "P");
    assert_true(r.has_basis && r.basis == ORL_BSDF_TENSOR_TREE_4);
    assert_int_equal(r.symmetry, ORL_BSDF_FIT_HALF_TURN);
    assert_int_equal(r.resolution, 32);
    assert_true(r.cull == 0.1 && r.grazing_deg == 2.5 && r.reversed && r.keep_outliers);
    orl_bsdf_fit_request_done(&r);
    assert_int_equal(read_document("{" KIND DATA "}", ORL_JOB_LOCAL, &r, NULL, &err), 0);
    assert_true(!r.has_basis && r.symmetry == ORL_BSDF_FIT_AUTO && !r.reversed);
    assert_int_equal(r.resolution, 64);
    orl_bsdf_fit_request_done(&r);
}

static void what_is_wrong_is_told_with_its_place(void **state)
{
    static const struct {
        const char *text, *where;
    } cases[] = {
        {"{" DATA "}", "kind"},
        {"{\"kind\": \"bsdf_make\", " DATA "}", "kind"},
        {"{\"kind\": \"bsdf_fit\"}", "measurements"},
        {"{" KIND DATA ", \"basis\": \"klems\"}", "basis"},
        {"{" KIND DATA ", \"symmetry\": \"odd\"}", "symmetry"},
        {"{" KIND DATA ", \"resolution\": 256}", "resolution"},
        {"{" KIND DATA ", \"basis\": \"klems_half\", \"cull\": 0.1}", "cull"},
        {"{" KIND DATA ", \"grazing\": 46}", "grazing"},
        {"{" KIND DATA ", \"reversed\": 1}", "reversed"},
        {"{" KIND DATA ", \"paths\": 1}", "paths"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_bsdf_fit_request r;
        struct orl_error err;
        const int code = read_document(cases[i].text, ORL_JOB_LOCAL, &r, NULL, &err);
        if (code >= 0 || strcmp(err.primitive, cases[i].where) != 0)
            fail_msg("%s: %d, %s: %s", cases[i].text, code, err.primitive, err.message);
    }
}

/* A result with one scan that was left out and one that could not be fitted. */
static void what_was_fitted_is_told(void **state)
{
    char name[] = "a.txt", *names[] = {name};
    const struct orl_bsdf_fit_request request = {.files = names, .n_files = 1};
    struct orl_bsdf_fit_scan scans[2] = {{.front = true,
                                          .transmitted = true,
                                          .theta_deg = 30,
                                          .total = 0.5,
                                          .left_out = true,
                                          .predicted = 0.4,
                                          .misplaced = 0.1},
                                         {.theta_deg = 60}};
    struct orl_bsdf_fit_result fitted = {.scans = scans, .n_scans = 2, .n_outliers = 1};
    const char *component, *file;
    double predicted;
    json_t *other, *told;
    (void)state;
    fitted.has[1][1] = true;
    fitted.misplaced[1][1] = -1;
    fitted.outliers[0] = (struct orl_bsdf_outlier){.line = 7};
    json_t *json = orl_bsdf_fitted_to_json(&request, &fitted);
    assert_non_null(json);
    assert_int_equal(json_unpack(json, "{s:[{s:s, s:{s:f}}, {s:o}], s:{s:[{s:s}]}}", "scans",
                                 "component", &component, "left_out", "predicted", &predicted,
                                 "left_out", &other, "outliers", "told", "file", &file),
                     0);
    assert_string_equal(component, "transmission_front");
    assert_true(predicted == 0.4 && json_is_null(other));
    assert_string_equal(file, "a.txt");
    assert_int_equal(json_unpack(json, "{s:{s:o}}", "components", "reflection_back", &told), 0);
    assert_true(json_is_null(told));
    json_decref(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_says_what_is_fitted),
        cmocka_unit_test(what_is_wrong_is_told_with_its_place),
        cmocka_unit_test(what_was_fitted_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
