/* The Python package against a daemon: the cases of python_client.py. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/certificate.h"
#include "support/python_case.h"

#define PROGRAM "tests/api/python_client.py"

PYTHON_CASE(PROGRAM, whole_way)
PYTHON_CASE(PROGRAM, upload_if_absent)
PYTHON_CASE(PROGRAM, zips)
PYTHON_CASE(PROGRAM, skies)
PYTHON_CASE(PROGRAM, years)
PYTHON_CASE(PROGRAM, bsdfs)
PYTHON_CASE(PROGRAM, panels)
PYTHON_CASE(PROGRAM, measurements)
PYTHON_CASE(PROGRAM, cancel)
PYTHON_CASE(PROGRAM, labels)
PYTHON_CASE(PROGRAM, removal)
PYTHON_CASE(PROGRAM, problems)
PYTHON_CASE(PROGRAM, repeated_submission)

static void make_token(const struct daemon *daemon, const char *scope, char ret_token[100])
{
    char command[400];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(command, sizeof command, "%s/orield token add %s --scope %s --data %s",
             build ? build : "build", scope, scope, daemon->root);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    assert_int_equal(fscanf(pipe, "%99s", ret_token), 1);
    assert_int_equal(pclose(pipe), 0);
}

static void test_tokens(void **state)
{
    struct python_fixture *f = *state;
    char key[80];
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    make_token(&f->daemon, "submit", f->submit);
    make_token(&f->daemon, "read", f->read);
    snprintf(f->cert, sizeof f->cert, "%s/cert.pem", f->daemon.root);
    snprintf(key, sizeof key, "%s/key.pem", f->daemon.root);
    certificate_make(f->cert, key);
    const char *const extra[] = {"--tokens",  "always", "--tls-cert", f->cert,
                                 "--tls-key", key,      NULL};
    daemon_restart(&f->daemon, extra);
    python_case_run(f, PROGRAM, "tokens");
    python_case_run(f, PROGRAM, "whole_way");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole_way),
        cmocka_unit_test(test_upload_if_absent),
        cmocka_unit_test(test_zips),
        cmocka_unit_test(test_skies),
        cmocka_unit_test(test_years),
        cmocka_unit_test(test_bsdfs),
        cmocka_unit_test(test_panels),
        cmocka_unit_test(test_measurements),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_labels),
        cmocka_unit_test(test_removal),
        cmocka_unit_test(test_problems),
        cmocka_unit_test(test_repeated_submission),
        cmocka_unit_test(test_tokens),
    };
    return cmocka_run_group_tests(tests, python_fixture_start, python_fixture_end);
}
