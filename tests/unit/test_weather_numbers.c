/*
 * Warnings about contradictory numbers in an EPW file: shifted times, direct irradiance for
 * another sun or on the horizontal, rows that were not measured.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "light/daylight/weather.h"
#include "scene/generate/sky/sun.h"

enum { TEXT = 1 << 15, DAYS = 20, FIRST_HOUR = 8, LAST_HOUR = 17 };

/* Computes a row's global, direct and diffuse irradiance, by the sine of the sun's altitude at its
 * middle, and half an hour before. */
struct numbers {
    double global, direct, diffuse;
};
typedef struct numbers (*maker)(double sine, double sine_before);

static struct numbers right(double sine, double before)
{
    (void)before;
    return (struct numbers){100 + 700 * sine, 700, 100};
}

static struct numbers half_an_hour_late(double sine, double before)
{
    (void)sine;
    return (struct numbers){100 + 700 * before, 700, 100};
}

static struct numbers direct_by_another_sun(double sine, double before)
{
    return (struct numbers){100 + 700 * sine, 700 * sine / before, 100};
}

static struct numbers no_diffuse(double sine, double before)
{
    (void)before;
    return (struct numbers){900 * sine, 900 * sine, 0};
}

static struct numbers horizontal(double sine, double before)
{
    (void)before;
    return (struct numbers){100 + 700 * sine, 700 * sine, 100};
}

/* Writes clear days at 38 degrees north; returns the text's length. */
static size_t write_days(maker make, char text[TEXT])
{
    const struct orl_location site = {38 * ORL_DEG_TO_RAD, 0, 0};
    size_t n = (size_t)snprintf(
        text, TEXT, "LOCATION,a,b,c,d,e,38,0,0,25\nDATA PERIODS,1,1,Data,Sunday,6/1,6/20\n");
    for (int day = 1; day <= DAYS; day++)
        for (int hour = FIRST_HOUR; hour <= LAST_HOUR; hour++) {
            const struct orl_moment at = {2021, 6, day, hour - 0.5, false};
            const struct orl_moment before = {2021, 6, day, hour - 1, false};
            const struct numbers row = make(sin(orl_sun_accurate(&site, &at).altitude_rad),
                                            sin(orl_sun_accurate(&site, &before).altitude_rad));
            n += (size_t)snprintf(text + n, TEXT - n,
                                  "2021,6,%d,%d,0,f,0,0,0,0,0,0,0,%.2f,%.2f,%.2f\n", day, hour,
                                  row.global, row.direct, row.diffuse);
            assert_true(n < TEXT);
        }
    return n;
}

static void test_words(void **state)
{
    static const struct {
        maker make;
        const char *said; /* NULL: no warning */
    } cases[] = {{right, NULL},
                 {half_an_hour_late, "times seem 30 minutes too late"},
                 {direct_by_another_sun, "fits a sun 30 minutes earlier"},
                 {no_diffuse, "diffuse irradiance is 0 by day"},
                 {horizontal, "seems to be horizontal"}};
    static char text[TEXT];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_weather weather = {0};
        char said[640] = "";
        const size_t length = write_days(cases[i].make, text);
        assert_int_equal(orl_weather_parse("a.epw", text, length, 0, &weather, NULL), 0);
        const struct orl_time_shift shift = orl_time_shift_find(&weather);
        const bool says = orl_time_shift_describe(&shift, said, sizeof said);
        print_message("%zu: %s\n", i, said);
        assert_int_equal(says, cases[i].said != NULL);
        assert_true(!says || strstr(said, cases[i].said));
        orl_weather_done(&weather);
    }
}

/* 9999 and -999 mark missing measurements; -2 is an instrument's offset at night. */
static void test_missing(void **state)
{
    static const char text[] =
        "LOCATION,a,b,c,d,e,38,0,0,25\nDATA PERIODS,1,1,Data,Sunday,6/1,6/1\n"
        "2021,6,1,9,0,f,0,0,0,0,0,0,0,9999,9999,9999\n"
        "2021,6,1,10,0,f,0,0,0,0,0,0,0,-999,-999,-999\n"
        "2021,6,1,11,0,f,0,0,0,0,0,0,0,100,-999,100\n"
        "2021,6,1,12,0,f,0,0,0,0,0,0,0,100,-2,100\n";
    struct orl_weather weather = {0};
    (void)state;
    assert_int_equal(orl_weather_parse("a.epw", text, sizeof text - 1, 0, &weather, NULL), 0);
    assert_int_equal(weather.n_rows, 4);
    for (size_t i = 0; i < weather.n_rows; i++)
        assert_int_equal(weather.rows[i].missing, i < 3);
    orl_weather_done(&weather);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_words),
                                       cmocka_unit_test(test_missing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
