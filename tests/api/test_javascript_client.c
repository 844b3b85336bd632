/* client/javascript/oriel.js against the daemon: the cases of javascript_client.mjs, each in a
 * separate process of Node. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/daemon.h"

static void run_case(const struct daemon *daemon, const char *name)
{
    char folder[] = "/tmp/oriel-test-XXXXXX", command[700];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command,
             "env -u ORIEL_URL -u ORIEL_TOKEN -u ORIEL_CLIENT timeout 550 node "
             "tests/api/javascript_client.mjs %s %s %s >&2",
             name, daemon->url, folder);
    const int status = system(command);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    if (status != 0)
        fail_msg("%s: status %d (node is of make deps-check)", name, status);
}

#define CASE(name)                                                                                 \
    static void test_##name(void **state)                                                          \
    {                                                                                              \
        run_case(*state, #name);                                                                   \
    }
CASE(whole_way)
CASE(example)
CASE(upload_if_absent)
CASE(bundles)
CASE(skies_and_years)
CASE(panels)
CASE(cancel)
CASE(polling)
CASE(broken_connection)
CASE(problems)
CASE(lists)

static int setup(void **state)
{
    static struct daemon daemon;
    daemon_start(&daemon, NULL);
    *state = &daemon;
    return 0;
}

static int teardown(void **state)
{
    daemon_remove(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole_way),
        cmocka_unit_test(test_example),
        cmocka_unit_test(test_upload_if_absent),
        cmocka_unit_test(test_bundles),
        cmocka_unit_test(test_skies_and_years),
        cmocka_unit_test(test_panels),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_polling),
        cmocka_unit_test(test_broken_connection),
        cmocka_unit_test(test_problems),
        cmocka_unit_test(test_lists),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
