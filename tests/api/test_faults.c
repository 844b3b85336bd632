/* The quick parts of tests/torture: faults of the disk and the database, and malformed requests. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/extent.h"

static void run_script(const char *script, const char *arguments)
{
    const char *build = getenv("ORIEL_BUILD");
    char command[512];
    if (!build)
        build = "build";
    snprintf(
        command, sizeof command,
        "PYTHONPYCACHEPREFIX=%s/pycache timeout 550 /usr/bin/python3 tests/torture/%s %s %s >&2",
        build, script, build, arguments);
    assert_int_equal(system(command), 0);
}

static void test_full_disk(void **state)
{
    (void)state;
    run_script("faults.py", "disk_full");
}

static void test_slow_disk(void **state)
{
    (void)state;
    run_script("faults.py", "slow_disk");
}

static void test_removal_beside_upload(void **state)
{
    (void)state;
    run_script("faults.py", "removal_beside_upload");
}

static void test_damaged_upload(void **state)
{
    (void)state;
    run_script("faults.py", "flipped_blob");
}

static void test_damaged_result(void **state)
{
    (void)state;
    run_script("faults.py", "flipped_result");
}

static void test_locked_database(void **state)
{
    (void)state;
    run_script("faults.py", "locked_database");
}

static void test_damaged_database(void **state)
{
    (void)state;
    run_script("faults.py", "damaged_database");
}

static void test_no_descriptors(void **state)
{
    (void)state;
    run_script("faults.py", "no_descriptors");
}

static void test_each_call_of_an_upload(void **state)
{
    (void)state;
    run_script("every.py", "write_of_an_upload sync_of_an_upload name_of_an_upload");
}

static void test_power_cuts(void **state)
{
    (void)state;
    run_script("powercuts.py", "--cuts 6");
}

static void test_malformed_requests(void **state)
{
    (void)state;
    run_script("malformed.py", extent_is_long() ? "--count 1000" : "--count 400");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_slow_disk),
        cmocka_unit_test(test_damaged_upload),
        cmocka_unit_test(test_damaged_result),
        cmocka_unit_test(test_locked_database),
        cmocka_unit_test(test_damaged_database),
        cmocka_unit_test(test_no_descriptors),
        cmocka_unit_test(test_each_call_of_an_upload),
        cmocka_unit_test(test_power_cuts),
        cmocka_unit_test(test_malformed_requests),
        cmocka_unit_test(test_removal_beside_upload),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
