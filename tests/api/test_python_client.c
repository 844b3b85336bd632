/* client/python/oriel.py against the daemon: the cases of python_client.py, each in a separate
 * Python process. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/certificate.h"
#include "support/daemon.h"

struct fixture {
    struct daemon daemon;
    char cert[80], submit[100], read[100]; /* "": the daemon has no tokens */
};

static void run_case(const struct fixture *f, const char *name)
{
    char folder[] = "/tmp/oriel-test-XXXXXX", command[700];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command,
             "READ_TOKEN='%s' PYTHONDONTWRITEBYTECODE=1 timeout 550 /usr/bin/python3 -W error "
             "tests/api/python_client.py %s %s %s '%s' '%s' >&2",
             f->read, name, f->daemon.url, folder, f->cert, f->submit);
    const int status = system(command);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    if (status != 0)
        fail_msg("%s: status %d", name, status);
}

#define CASE(name)                                                                                 \
    static void test_##name(void **state)                                                          \
    {                                                                                              \
        run_case(*state, #name);                                                                   \
    }
CASE(old_python)
CASE(whole_way)
CASE(example)
CASE(upload_if_absent)
CASE(zips)
CASE(skies)
CASE(years)
CASE(bsdfs)
CASE(panels)
CASE(measurements)
CASE(cancel)
CASE(labels)
CASE(removal)
CASE(problems)
CASE(repeated_submission)

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
    struct fixture *f = *state;
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
    run_case(f, "tokens");
    run_case(f, "whole_way");
}

static int setup(void **state)
{
    static struct fixture f;
    daemon_start(&f.daemon, NULL);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    daemon_remove(&((struct fixture *)*state)->daemon);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_old_python),
        cmocka_unit_test(test_whole_way),
        cmocka_unit_test(test_example),
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
    return cmocka_run_group_tests(tests, setup, teardown);
}
