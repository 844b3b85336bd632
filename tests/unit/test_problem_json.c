/* Problem documents (RFC 9457): round trip, and an HTTP status for every error. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <jansson.h>
#include <string.h>

#include "json/problem.h"

static void test_there_and_back(void **state)
{
    (void)state;
    struct orl_error err, back;
    orl_error_set(&err, ORL_ERR_SYNTAX, "three numbers are expected");
    orl_error_at(&err, "room.rad", 12, "polygon floor");
    orl_error_hint(&err, "Count them");
    int status = 0;
    json_t *problem = orl_problem_from_error(&err, &status);
    assert_non_null(problem);
    assert_int_equal(status, 400);
    assert_int_equal(json_integer_value(json_object_get(problem, "status")), 400);
    assert_string_equal(json_string_value(json_object_get(problem, "type")),
                        "urn:oriel:error:syntax");
    assert_string_equal(json_string_value(json_object_get(problem, "file")), "room.rad");
    orl_problem_to_error(problem, &back);
    assert_int_equal(back.code, err.code);
    assert_int_equal(back.line, 12);
    assert_string_equal(back.message, err.message);
    assert_string_equal(back.file, err.file);
    assert_string_equal(back.primitive, err.primitive);
    assert_string_equal(back.hint, err.hint);
    json_decref(problem);
}

static void test_absent_members_are_absent(void **state)
{
    (void)state;
    struct orl_error err;
    orl_error_set(&err, ORL_ERR_NOMEM, "no memory");
    json_t *problem = orl_problem_from_error(&err, NULL);
    assert_null(json_object_get(problem, "file"));
    assert_null(json_object_get(problem, "line"));
    assert_null(json_object_get(problem, "primitive"));
    assert_null(json_object_get(problem, "hint"));
    json_decref(problem);
}

static void test_every_code_has_a_status(void **state)
{
    (void)state;
    for (int code = ORL_ERR_NOMEM; code >= ORL_ERR_UNLIT; code--) {
        const int status = orl_problem_status(code);
        assert_in_range(status, 400, 599);
        struct orl_error err, back;
        orl_error_set(&err, code, "x");
        json_t *problem = orl_problem_from_error(&err, NULL);
        orl_problem_to_error(problem, &back);
        assert_int_equal(back.code, code);
        json_decref(problem);
    }
    assert_int_equal(orl_problem_status(-999), 500);
}

/* Errors of the client are 4xx, those of the server 5xx. */
static void test_crash_record(void **state)
{
    (void)state;
    static const int theirs[] = {ORL_ERR_SYNTAX,    ORL_ERR_UNSUPPORTED, ORL_ERR_RANGE,
                                 ORL_ERR_NOT_FOUND, ORL_ERR_LIMIT,       ORL_ERR_INVALID};
    static const int ours[] = {ORL_ERR_NOMEM, ORL_ERR_IO, ORL_ERR_FULL, ORL_ERR_CORRUPT,
                               ORL_ERR_INTERNAL};
    for (size_t i = 0; i < sizeof theirs / sizeof *theirs; i++)
        assert_in_range(orl_problem_status(theirs[i]), 400, 499);
    for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
        assert_in_range(orl_problem_status(ours[i]), 500, 599);
}

static void test_full_disk(void **state)
{
    (void)state;
    assert_int_equal(orl_err_of_errno(ENOSPC), ORL_ERR_FULL);
    assert_int_equal(orl_err_of_errno(EDQUOT), ORL_ERR_FULL);
    assert_int_equal(orl_err_of_errno(EACCES), ORL_ERR_IO);
    assert_int_equal(orl_problem_status(ORL_ERR_FULL), 507);
}

static void test_text_that_is_not_utf8(void **state)
{
    (void)state;
    struct orl_error err;
    orl_error_set(&err, ORL_ERR_SYNTAX, "bad word '%s'", "\xff\xfe");
    orl_error_at(&err, "r\xe4um.rad", 1, NULL);
    json_t *problem = orl_problem_from_error(&err, NULL);
    assert_non_null(problem);
    assert_string_equal(json_string_value(json_object_get(problem, "file")), "r?um.rad");
    json_decref(problem);
}

static void test_other_documents_leave_fields_empty(void **state)
{
    (void)state;
    struct orl_error err;
    json_t *problem = json_loads("{\"title\":\"Bad Gateway\",\"type\":7,\"line\":\"x\"}", 0, NULL);
    orl_problem_to_error(problem, &err);
    assert_int_equal(err.code, ORL_ERR_INVALID);
    assert_string_equal(err.message, "Bad Gateway");
    assert_string_equal(err.file, "");
    assert_int_equal(err.line, 0);
    json_decref(problem);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_there_and_back),
        cmocka_unit_test(test_absent_members_are_absent),
        cmocka_unit_test(test_every_code_has_a_status),
        cmocka_unit_test(test_crash_record),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_text_that_is_not_utf8),
        cmocka_unit_test(test_other_documents_leave_fields_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
