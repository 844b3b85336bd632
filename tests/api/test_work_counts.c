/*
 * Rays, density estimates and map bytes of fixed small jobs are at most 2 % above the best commit
 * on record (tests/bench/ratchet). Their instructions and errors are compared by `make check-perf`.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

static void test_jobs_do_no_more_work_than_on_record(void **state)
{
    char command[256];
    (void)state;
    snprintf(command, sizeof command,
             "PYTHONDONTWRITEBYTECODE=1 timeout 550 /usr/bin/python3 "
             "tests/bench/ratchet/ratchet.py counts '%s' >&2",
             getenv("ORIEL_BUILD"));
    assert_int_equal(system(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_jobs_do_no_more_work_than_on_record)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
