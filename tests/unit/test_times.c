/* Times as text, before 1970 and at the limits of four-digit years. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "process/times.h"

static void test_format(void **state)
{
    static const struct {
        int64_t ms;
        const char *text;
    } times[] = {
        {0, "1970-01-01T00:00:00.000Z"},
        {1711107000123, "2024-03-22T11:30:00.123Z"},
        {-1, "1969-12-31T23:59:59.999Z"},
        {-831, "1969-12-31T23:59:59.169Z"},
        {-1000, "1969-12-31T23:59:59.000Z"},
        {-86400000, "1969-12-31T00:00:00.000Z"},
        {-62167219200000, "0000-01-01T00:00:00.000Z"},
        {253402300799999, "9999-12-31T23:59:59.999Z"},
        {INT64_MIN, "0000-01-01T00:00:00.000Z"},
        {INT64_MAX, "9999-12-31T23:59:59.999Z"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        char text[ORL_TIME_TEXT];
        orl_time_format(times[i].ms, text);
        assert_string_equal(text, times[i].text);
    }
}

/* Parsing a formatted time gives the same time, from 1970 on. */
static void test_read_back(void **state)
{
    static const int64_t times[] = {0, 1, 999, 1000, 1711107000123, 253402300799999};
    (void)state;
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        char text[ORL_TIME_TEXT];
        int64_t ms = -1;
        orl_time_format(times[i], text);
        assert_true(orl_time_parse(text, &ms));
        assert_int_equal(ms, times[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_format),
        cmocka_unit_test(test_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
