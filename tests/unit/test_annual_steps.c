/* Steps of a year that count: leap years, occupancy by the clock and by files, daylight hours. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/annual/annual_metrics.h>

#include "metrics/annual/annual_figures.h"
static const struct orl_annual_steps hourly = {8760, 1}, leap = {8784, 1}, halves = {17520, 2};

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

static size_t count_marks(const unsigned char *marks, size_t n)
{
    size_t sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += marks[i];
    return sum;
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static void test_years(void **state)
{
    const struct orl_annual_steps odd = {8761, 1}, none = {0, 0};
    struct orl_calendar_day day;
    (void)state;
    assert_int_equal(orl_annual_steps_check(&hourly, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&leap, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&halves, NULL), 0);
    assert_int_equal(orl_annual_steps_check(&odd, NULL), ORL_ERR_RANGE);
    assert_int_equal(orl_annual_steps_check(&none, NULL), ORL_ERR_RANGE);
    day = orl_calendar_day_of(&hourly, 59 * 24);
    assert_true(day.month == 3 && day.day == 1);
    day = orl_calendar_day_of(&leap, 59 * 24 + 23);
    assert_true(day.month == 2 && day.day == 29);
    day = orl_calendar_day_of(&leap, 8783);
    assert_true(day.month == 12 && day.day == 31);
    day = orl_calendar_day_of(&halves, 17519);
    assert_true(day.month == 12 && day.day == 31);
    assert_near(orl_calendar_hour_of(&halves, 17519), 23.75, 0);
}

/* LM-83's 3650 hours; weekdays of a year that begins on a Sunday; a night shift. */
static void test_occupancy_by_the_clock(void **state)
{
    unsigned char *marks = malloc(17520);
    struct orl_occupancy use;
    (void)state;
    assert_non_null(marks);
    orl_occupancy_init(&use);
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 3650);
    assert_int_equal(count_marks(marks, 8), 0);
    assert_true(marks[8] && marks[17] && !marks[18]);
    orl_occupancy_mark(&use, &leap, marks);
    assert_int_equal(count_marks(marks, 8784), 3660);
    orl_occupancy_mark(&use, &halves, marks);
    assert_int_equal(count_marks(marks, 17520), 7300);
    use.days = 0x1f;
    use.first_day = 6;
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 2600); /* 260 weekdays: 53 Sundays, 52 Saturdays */
    assert_int_equal(count_marks(marks, 24), 0);
    orl_occupancy_init(&use);
    use.from_h = 22;
    use.to_h = 6;
    orl_occupancy_mark(&use, &hourly, marks);
    assert_int_equal(count_marks(marks, 8760), 365 * 8);
    assert_true(marks[22] && marks[0] && !marks[6]);
    free(marks);
}

/* Writes a schedule in DAYSIM's form, weekdays 8 to 17, by hours or half hours; or one column. */
static char *write_schedule(const struct orl_annual_steps *steps, bool times, size_t lines)
{
    char *text = malloc(32 * (lines + 3)), *at = text;
    assert_non_null(text);
    at += sprintf(at, "# a schedule\n%s\n\n", times ? "month,day,hour,occupancy" : "use");
    for (uint32_t i = 0; i < lines; i++) {
        const struct orl_calendar_day day = orl_calendar_day_of(steps, i % steps->count);
        const double hour = orl_calendar_hour_of(steps, i % steps->count);
        const bool used = hour > 8 && hour < 17;
        if (times)
            at += sprintf(at, "%d,%d,%.3f,%d\r\n", day.month, day.day, hour, used);
        else
            at += sprintf(at, "%s\n", used ? "0.95" : "0");
    }
    return text;
}

static int read_schedule(const struct orl_annual_steps *as, bool times, size_t lines,
                         const struct orl_annual_steps *year, unsigned char *marks,
                         struct orl_error *err)
{
    char *text = write_schedule(as, times, lines);
    const int code = orl_occupancy_read("use.csv", text, strlen(text), year, marks, err);
    free(text);
    return code;
}

static void test_occupancy_files(void **state)
{
    unsigned char *marks = malloc(17520);
    struct orl_error err = {0};
    (void)state;
    assert_non_null(marks);
    for (int times = 0; times < 2; times++) {
        assert_int_equal(read_schedule(&hourly, times, 8760, &hourly, marks, &err), 0);
        assert_int_equal(count_marks(marks, 8760), 365 * 9);
        assert_true(!marks[7] && marks[8] && marks[16] && !marks[17]);
        assert_int_equal(read_schedule(&hourly, times, 8760, &halves, marks, &err), 0);
        assert_int_equal(count_marks(marks, 17520), 365 * 18);
        assert_true(!marks[15] && marks[16] && marks[33] && !marks[34]);
        assert_int_equal(read_schedule(&hourly, times, 8759, &hourly, marks, &err), ORL_ERR_RANGE);
        assert_int_equal(read_schedule(&hourly, times, 8761, &hourly, marks, &err), ORL_ERR_RANGE);
        assert_int_equal(err.line, 8764);
    }
    assert_int_equal(read_schedule(&halves, true, 17520, &halves, marks, &err), 0);
    assert_int_equal(count_marks(marks, 17520), 365 * 18);
    /* A leap year's file used for another year: the error names the first wrong day. */
    assert_int_equal(read_schedule(&leap, true, 8784, &hourly, marks, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 4 + 59 * 24);
    assert_int_equal(orl_occupancy_read("x", "1\n2\nthree\n", 10, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(err.line, 3);
    assert_int_equal(orl_occupancy_read("x", "1,2\n", 4, &hourly, marks, &err), ORL_ERR_SYNTAX);
    /* A first row that is not finite is not taken for a heading. */
    assert_int_equal(orl_occupancy_read("x", "nan\n1\n", 6, &hourly, marks, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 1);
    assert_int_equal(orl_occupancy_read("x", "-inf\n1\n", 7, &hourly, marks, &err), ORL_ERR_RANGE);
    assert_int_equal(orl_occupancy_read("x", "1\n1,1,1.5,1\n", 12, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(err.line, 2);
    assert_int_equal(orl_occupancy_read("x", "1,1,.5,1\n1\n", 11, &hourly, marks, &err),
                     ORL_ERR_SYNTAX);
    assert_int_equal(orl_occupancy_read("x", "", 0, &hourly, marks, &err), ORL_ERR_RANGE);
    free(marks);
}

/* A UTF-8 byte order mark before the first number is not taken for a heading. */
static void test_marked_occupancy_file(void **state)
{
    char *text = malloc(3 + 2 * 8760 + 1);
    unsigned char *marks = malloc(8760);
    struct orl_error err = {0};
    (void)state;
    assert_true(text && marks);
    char *at = stpcpy(text, "\xef\xbb\xbf");
    for (int i = 0; i < 8760; i++)
        at = stpcpy(at, i == 0 ? "1\n" : "0\n");
    assert_int_equal(orl_occupancy_read("x", text, strlen(text), &hourly, marks, &err), 0);
    assert_int_equal(marks[0], 1);
    assert_int_equal(count_marks(marks, 8760), 1);
    assert_int_equal(orl_occupancy_read("x", text, strlen(text) - 2, &hourly, marks, &err),
                     ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "8759 lines"));
    assert_non_null(strstr(err.hint, "8760"));
    free(text);
    free(marks);
}

/* Daylight hours are exactly half of the year, the earlier of equal steps first; also where most
 * of it is dark. */
static void test_daylight_hours(void **state)
{
    double *light = calloc(8784, sizeof *light);
    unsigned char *marks = malloc(8784);
    (void)state;
    assert_true(light && marks);
    for (uint32_t i = 0; i < 8784; i++)
        light[i] = fmax(0, sin(i * 6.283185307179586 / 24)) + 1e-9 * i;
    assert_int_equal(orl_annual_daylight_mark(light, NULL, &leap, marks, NULL), 0);
    assert_int_equal(count_marks(marks, 8784), 4392);
    memset(light, 0, 8784 * sizeof *light);
    light[8000] = 1;
    assert_int_equal(orl_annual_daylight_mark(light, NULL, &hourly, marks, NULL), 0);
    assert_int_equal(count_marks(marks, 8760), 4380);
    assert_true(marks[8000] && marks[0] && marks[4378] && !marks[4379]);
    free(light);
    free(marks);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_years),           cmocka_unit_test(test_occupancy_by_the_clock),
        cmocka_unit_test(test_occupancy_files), cmocka_unit_test(test_marked_occupancy_file),
        cmocka_unit_test(test_daylight_hours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
