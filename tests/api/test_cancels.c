/* The quick form of tests/torture/cancel_kinds.py: every kind of work is cancelled at random
 * moments. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "process/limits.h"

static void test_every_kind(void **state)
{
    const char *build = getenv("ORIEL_BUILD");
    char command[256];
    (void)state;
    if (ORL_SANITIZED)
        skip(); /* the limits are those of a release build */
    snprintf(command, sizeof command,
             "PYTHONDONTWRITEBYTECODE=1 timeout 550 /usr/bin/python3 tests/torture/cancel_kinds.py "
             "%s --quick "
             "--moments 2 >&2",
             build ? build : "build");
    assert_int_equal(system(command), 0);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
