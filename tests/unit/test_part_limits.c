/* Limits that Slurm enforces on parts: with a margin, and never below the need of any part. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "distributed/runner.h"

static const struct orl_part_limits_input usual = {
    .load_s = 30, .time_ratio = 1, .threads = 4, .memory_bytes = 1000UL << 20};

static void assert_limits(struct orl_part_needs needs, struct orl_part_limits_input input,
                          uint32_t minutes, uint32_t mib)
{
    const struct orl_part_limits limits = orl_part_limits(&needs, &input);
    assert_int_equal(limits.minutes, minutes);
    assert_int_equal(limits.mib, mib);
}

/* 120 s, four times 30 s, eight times 7200 s / 4; memory is half as much again in steps of 64 MiB.
 */
static void test_a_part_of_two_hours(void **state)
{
    (void)state;
    assert_limits((struct orl_part_needs){7200, 0}, usual, 244, 1536);
}

static void test_small_parts_get_the_least(void **state)
{
    struct orl_part_limits_input small = usual;
    (void)state;
    small.memory_bytes = 1;
    assert_limits((struct orl_part_needs){1, 0}, small, ORL_PART_LEAST_MINUTES, ORL_PART_LEAST_MIB);
}

static void test_what_is_not_known_is_not_limited(void **state)
{
    (void)state;
    assert_limits((struct orl_part_needs){0, 0}, usual, 0, 1536);
}

/* If parts took three times the predicted time, later limits are three times as long; faster parts
 * do not reduce them. */
static void test_parts_that_have_ended_count(void **state)
{
    struct orl_part_limits_input slow = usual, fast = usual;
    (void)state;
    slow.time_ratio = 3;
    fast.time_ratio = 0.1;
    assert_limits((struct orl_part_needs){7200, 0}, slow, 724, 1536);
    assert_limits((struct orl_part_needs){7200, 0}, fast, 244, 1536);
}

/* Without a known memory use of the job, the limit covers this process and the task. */
static void test_memory_by_this_process(void **state)
{
    struct orl_part_limits_input unknown = usual;
    (void)state;
    unknown.memory_bytes = 0;
    const struct orl_part_needs much = {0, 4096UL << 20};
    const struct orl_part_limits limits = orl_part_limits(&much, &unknown);
    assert_true(limits.mib >= 6144 && limits.mib < 6144 + 1024);
}

static void test_limits_are_raised(void **state)
{
    const struct orl_part_limits limits = {30, 512};
    (void)state;
    assert_int_equal(orl_part_limits_raised(limits, ORL_PART_OUT_OF_TIME).minutes, 60);
    assert_int_equal(orl_part_limits_raised(limits, ORL_PART_OUT_OF_TIME).mib, 512);
    assert_int_equal(orl_part_limits_raised(limits, ORL_PART_OUT_OF_MEMORY).mib, 1024);
    assert_int_equal(orl_part_limits_raised(limits, ORL_PART_ENDED).minutes, 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_part_of_two_hours),
        cmocka_unit_test(test_small_parts_get_the_least),
        cmocka_unit_test(test_what_is_not_known_is_not_limited),
        cmocka_unit_test(test_parts_that_have_ended_count),
        cmocka_unit_test(test_memory_by_this_process),
        cmocka_unit_test(test_limits_are_raised),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
