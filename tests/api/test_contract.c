/*
 * The daemon implements api/openapi: every operation, every documented status, nothing else.
 * tests/contract/run.py tests this with the table of routes from this program.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "handlers/handlers.h"

static void test_contract(void **state)
{
    (void)state;
    char path[] = "/tmp/oriel-test-XXXXXX", command[160];
    const int fd = mkstemp(path);
    FILE *routes = fd < 0 ? NULL : fdopen(fd, "w");
    assert_non_null(routes);
    for (size_t i = 0; i < orl_routes.count; i++)
        fprintf(routes, "%s %s\n", orl_routes.table[i].method, orl_routes.table[i].path);
    assert_int_equal(fclose(routes), 0);
    /* Debian's own Python, which has python3-yaml. */
    snprintf(command, sizeof command,
             "PYTHONDONTWRITEBYTECODE=1 timeout 550 /usr/bin/python3 tests/contract/run.py %s >&2",
             path);
    const int status = system(command);
    unlink(path);
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_contract)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
