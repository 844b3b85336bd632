/* EPW and WEA files: small ones written for the test, valid and invalid. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "light/daylight/weather.h"
#include "support/scene_text.h"

#define LOCATION "LOCATION,Somewhere,-,TST,made up,000000,38.42,27.14,2.0,25.0\n"
#define PERIODS "DATA PERIODS,1,1,Data,Sunday,1/1,12/31\n"
#define EPW LOCATION PERIODS
#define WEA                                                                                        \
    "place Somewhere_TST\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\nsite_elevation 25\n"    \
    "weather_data_file_units 1\n"
/* A row up to the direct normal irradiance. */
#define TO_DIRECT(month, day, hour)                                                                \
    "2020," #month "," #day "," #hour ",0,flags,9,7,87,101300,0,0,305,0,"

static int parse(const char *text, struct orl_weather *weather, struct orl_error *err)
{
    return orl_weather_parse("x.epw", text, strlen(text), 0, weather, err);
}

static struct orl_weather parse_good(const char *text)
{
    struct orl_weather weather = {0};
    struct orl_error err = {0};
    if (parse(text, &weather, &err) < 0)
        fail_msg("line %d: %s", err.line, err.message);
    return weather;
}

static void assert_site(const struct orl_weather *weather)
{
    assert_true(weather->latitude_deg == 38.42);
    assert_true(weather->longitude_deg == 27.14);
    assert_true(weather->time_zone_h == 2);
}

/* One hour in both formats: longitude east in one, west in the other; the hour's end and its
 * middle. */
static void test_both_formats_agree(void **state)
{
    struct orl_weather epw = parse_good(EPW TO_DIRECT(3, 22, 12) "800,120,0,0,0\n");
    struct orl_weather wea = parse_good(WEA "3 22 11.500 800 120\n");
    (void)state;
    assert_site(&epw);
    assert_site(&wea);
    assert_int_equal(epw.units, wea.units);
    assert_int_equal(epw.n_rows, 1);
    assert_int_equal(wea.n_rows, 1);
    const struct orl_weather_row *a = epw.rows, *b = wea.rows;
    assert_true(a->month == 3 && a->day == 22 && a->hour == 11.5);
    assert_true(a->direct == 800 && a->diffuse == 120 && !a->missing);
    assert_true(b->month == 3 && b->day == 22 && b->hour == 11.5);
    assert_true(b->direct == 800 && b->diffuse == 120 && !b->missing);
    assert_int_equal(a->line, 3);
    assert_int_equal(b->line, 7);
    orl_weather_done(&epw);
    orl_weather_done(&wea);
}

/* Fixture files in the full layout: eight header lines, two days of hours. */
static void test_fixtures(void **state)
{
    static const char *const paths[2] = {"tests/fixtures/weather.epw",
                                         "tests/fixtures/weather.wea"};
    struct orl_weather weather[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        size_t size;
        struct orl_error err;
        unsigned char *text = scene_read_bytes(paths[i], &size);
        assert_int_equal(orl_weather_parse(paths[i], (char *)text, size, 0, &weather[i], &err), 0);
        free(text);
        assert_int_equal(weather[i].n_rows, 48);
    }
    for (size_t k = 0; k < 48; k++) {
        const struct orl_weather_row *a = &weather[0].rows[k], *b = &weather[1].rows[k];
        assert_true(a->month == b->month && a->day == b->day && a->hour == b->hour);
        assert_true(a->direct == b->direct && a->diffuse == b->diffuse);
        assert_true(a->missing == b->missing);
    }
    const struct orl_weather_row *noon = orl_weather_find(&weather[0], 3, 22, 11.5);
    assert_non_null(noon);
    assert_true(noon->direct == 812 && noon->diffuse == 119);
    orl_weather_done(&weather[0]);
    orl_weather_done(&weather[1]);
}

static void test_nearest_row(void **state)
{
    static const struct {
        int month, day;
        double hour, found; /* -1: none */
    } cases[] = {{1, 1, 0.5, 0.5},   {1, 1, 1.0, 1.5},    {1, 1, 0.99, 0.5}, {1, 1, 2.0, 1.5},
                 {1, 1, 2.01, -1},   {1, 1, 0, 0.5},      {2, 29, 12, 12},   {2, 28, 12, -1},
                 {3, 1, 12.5, 12.5}, {3, 1, 23.99, 23.5}, {4, 1, 1, -1}};
    struct orl_weather weather = parse_good(
        WEA "1 1 0.5 0 0\n1 1 1.5 1 1\n2 29 12 5 5\n3 1 12.5 9 9\r\n\n3\t1  23.5 0 0 extra\n");
    (void)state;
    assert_int_equal(weather.n_rows, 5);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_weather_row *row =
            orl_weather_find(&weather, cases[i].month, cases[i].day, cases[i].hour);
        if (cases[i].found < 0)
            assert_null(row);
        else
            assert_true(row && row->hour == cases[i].found);
    }
    orl_weather_done(&weather);
}

static void test_missing_values(void **state)
{
    struct orl_weather epw = parse_good(EPW TO_DIRECT(1, 1, 1) "9999,0,0\n" TO_DIRECT(
        1, 1, 2) "0,9999,0\n" TO_DIRECT(1, 1, 3) "9998,0,0\n");
    (void)state;
    assert_true(epw.rows[0].missing && epw.rows[1].missing && !epw.rows[2].missing);
    orl_weather_done(&epw);
    /* In lux, 9999 is an ordinary value. */
    struct orl_weather lux =
        parse_good("place a_b\nlatitude 0\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
                   "weather_data_file_units 3\n1 1 9.5 9999 20000\n1 1 10.5 999900 0\n");
    assert_int_equal(lux.units, ORL_WEATHER_NORMAL_LX);
    assert_true(!lux.rows[0].missing && lux.rows[1].missing);
    orl_weather_done(&lux);
}

/* Half-hour time zones are exact: India is at 82.5 degrees. */
static void test_half_hour_zone(void **state)
{
    struct orl_weather india =
        parse_good("place a_b\nlatitude 28.6\nlongitude -77.2\ntime_zone -82.5\n"
                   "site_elevation 216\nweather_data_file_units 2\n6 1 9.5 1 2\n");
    (void)state;
    assert_true(india.time_zone_h == 5.5);
    assert_int_equal(india.units, ORL_WEATHER_HORIZONTAL_W);
    orl_weather_done(&india);
}

static void test_bad_files(void **state)
{
    static const struct {
        const char *text;
        int code, line;
    } bad[] = {
        {"", ORL_ERR_SYNTAX, 1},
        {"\n\n", ORL_ERR_SYNTAX, 3},
        {"hello\n", ORL_ERR_SYNTAX, 1},
        {"LOCATION,a,b,c\n", ORL_ERR_SYNTAX, 1},
        {"LOCATION,a,b,c,d,e,91,0,0,0\n" PERIODS, ORL_ERR_RANGE, 1},
        {"LOCATION,a,b,c,d,e,0,181,0,0\n" PERIODS, ORL_ERR_RANGE, 1},
        {"LOCATION,a,b,c,d,e,0,0,nan,0\n" PERIODS, ORL_ERR_RANGE, 1},
        {LOCATION "COMMENTS 1,x\n", ORL_ERR_SYNTAX, 3},
        {LOCATION "a\nb\nc\nd\ne\nf\ng\nh\n" PERIODS, ORL_ERR_SYNTAX, 8},
        {LOCATION "DATA PERIODS,1\n", ORL_ERR_SYNTAX, 2},
        {LOCATION "DATA PERIODS,1,7,Data,Sunday,1/1,12/31\n", ORL_ERR_RANGE, 2},
        {LOCATION "DATA PERIODS,1,1.5,Data,Sunday,1/1,12/31\n" TO_DIRECT(3, 22, 12) "8,1,0\n",
         ORL_ERR_RANGE, 2},
        {LOCATION
         "DATA PERIODS,1,2,Data,Sunday,1/1,12/31\n" TO_DIRECT(3, 22, 12) "800,120,0\n" TO_DIRECT(
             3, 22, 12) "800,120,0\n" TO_DIRECT(3, 22, 12) "8,1,0\n",
         ORL_ERR_RANGE, 5},
        {EPW, ORL_ERR_SYNTAX, 3},
        {EPW TO_DIRECT(3, 22, 12) "800", ORL_ERR_SYNTAX, 3},
        {EPW TO_DIRECT(3, 22, 12) "800,", ORL_ERR_SYNTAX, 3},
        {EPW TO_DIRECT(3, 22, 12) "1e999,0,0\n", ORL_ERR_RANGE, 3},
        {EPW TO_DIRECT(13, 22, 12) "800,120,0\n", ORL_ERR_RANGE, 3},
        {EPW TO_DIRECT(2, 30, 12) "800,120,0\n", ORL_ERR_RANGE, 3},
        {EPW TO_DIRECT(2, 1.5, 12) "800,120,0\n", ORL_ERR_SYNTAX, 3},
        {EPW TO_DIRECT(3, 22, 0) "800,120,0\n", ORL_ERR_RANGE, 3},
        {EPW TO_DIRECT(3, 22, 25) "800,120,0\n", ORL_ERR_RANGE, 3},
        {EPW TO_DIRECT(3, 22, 12) "800,120,0\n" TO_DIRECT(3, 22, 13) "8\n", ORL_ERR_SYNTAX, 4},
        {WEA, ORL_ERR_SYNTAX, 7},
        {WEA "3 22 11.5 800\n", ORL_ERR_SYNTAX, 7},
        {WEA "3 22 11.5 800 x\n", ORL_ERR_SYNTAX, 7},
        {WEA "0 22 11.5 800 120\n", ORL_ERR_RANGE, 7},
        {WEA "3 22 -0.5 800 120\n", ORL_ERR_RANGE, 7},
        {"place a_b\nlongitude 0\n", ORL_ERR_SYNTAX, 2},
        {"place a_b\nlatitude 0\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
         "weather_data_file_units 4\n1 1 1 1 1\n",
         ORL_ERR_RANGE, 6},
        {"place a_b\nlatitude 0\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
         "weather_data_file_units 1.5\n1 1 1 1 1\n",
         ORL_ERR_RANGE, 6},
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct orl_weather weather = {.n_rows = 77};
        struct orl_error err = {0};
        const int code = parse(bad[i].text, &weather, &err);
        if (code != bad[i].code || err.line != bad[i].line)
            fail_msg("file %zu: code %d at line %d (%s), not %d at %d", i, code, err.line,
                     err.message, bad[i].code, bad[i].line);
        assert_string_equal(err.file, "x.epw");
        assert_int_equal(weather.n_rows, 77); /* unchanged */
    }
}

/* Rows from hour 0 to 23 are not EPW, whose hours end at 1 to 24. */
static void test_hours_from_zero(void **state)
{
    struct orl_weather weather;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse(EPW TO_DIRECT(1, 1, 0) "0,0,0\n", &weather, &err), ORL_ERR_RANGE);
    assert_int_equal(err.line, 3);
    assert_non_null(strstr(err.hint, "add 1 to the hours"));
}

/* Tables of other sources are refused by their names, with a remedy. */
static void test_other_forms(void **state)
{
    static const struct {
        const char *text, *form;
    } forms[] = {
        {"723170,\"A TOWN\",NC,-5.0,36.100,-79.950,273\nDate (MM/DD/YYYY),Time (HH:MM),ETR "
         "(W/m^2)\n",
         "TMY3"},
        {" 13723 A_TOWN                 NC  -5 N 36  5 W  79 57   270\n 68010101000000000000?0\n",
         "TMY2"},
        {"Latitude (decimal degrees): 45.000\r\nLongitude (decimal degrees): 8.000\r\n", "PVGIS"},
        {"Source,Location ID,City,State,Country,Latitude,Longitude\nNSRDB,1,-,-,-,40,-108\n",
         "NSRDB"},
        {"time(UTC),T2m,RH\n", "format is not supported"}};
    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        struct orl_weather weather;
        struct orl_error err = {0};
        assert_int_equal(parse(forms[i].text, &weather, &err), ORL_ERR_SYNTAX);
        print_message("# %s: %s\n", err.message, err.hint);
        assert_int_equal(err.line, 1);
        assert_non_null(strstr(err.hint, forms[i].form));
        assert_non_null(strstr(err.hint, "EPW"));
    }
}

/* Every prefix of a valid file, in a block of its exact size, is valid or gives an error. */
static void test_every_truncation(void **state)
{
    static const char good[] = EPW TO_DIRECT(3, 22, 12) "800,120,0\n";
    (void)state;
    for (size_t size = 0; size < sizeof good; size++) {
        char *text = malloc(size ? size : 1);
        struct orl_weather weather = {0};
        struct orl_error err = {0};
        assert_non_null(text);
        memcpy(text, good, size);
        const int code = orl_weather_parse("x.epw", text, size, 0, &weather, &err);
        assert_true(code == 0 ? weather.n_rows == 1 : err.code == code && err.line > 0);
        orl_weather_done(&weather);
        free(text);
    }
}

/* DATA PERIODS have the weekday of their first date: 1 July 2025 was a Tuesday, 1 January a
 * Wednesday. */
static void test_weekday_and_year(void **state)
{
    static const struct {
        const char *periods;
        int first_weekday;
    } cases[] = {{"DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n", 6},
                 {"DATA PERIODS,1,1,Data,monday,1/1,12/31\n", 0},
                 {"DATA PERIODS,1,1,Data,Tuesday, 7/ 1,12/31\n", 2},
                 {"DATA PERIODS,1,1,Data,Tuesday,1-Jul,Dec-31,,,\n", 2},
                 {"DATA PERIODS,1,1,Data,Tuesday,Jul-01,31-Dec\n", 2},
                 {"DATA PERIODS,1,1,Data,Someday,1/1,12/31\n", -1},
                 {"DATA PERIODS,1,1,Data,Sunday,13/1,12/31\n", -1},
                 {"DATA PERIODS,1,1\n", -1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s%s", LOCATION, cases[i].periods,
                 TO_DIRECT(7, 1, 12) "800,120,0,0,0\n");
        struct orl_weather weather = parse_good(text);
        assert_int_equal(weather.first_weekday, cases[i].first_weekday);
        assert_int_equal(weather.rows[0].year, 2020);
        orl_weather_done(&weather);
    }
    struct orl_weather wea = parse_good(WEA "3 22 11.500 800 120\n3 22 11.75 800 120\n");
    assert_int_equal(wea.first_weekday, -1);
    assert_int_equal(wea.rows[0].year, 0);
    assert_true(fabs(wea.interval_h - 0.25) < 1e-9);
    orl_weather_done(&wea);
    /* Times are rounded: 0.166 h and 0.167 h are 10 minutes. */
    wea = parse_good(WEA "3 22 0.583 0 0\n3 22 0.750 0 0\n3 22 0.917 0 0\n3 22 1.083 0 0\n");
    assert_true(fabs(wea.interval_h - 1.0 / 6) < 1e-9);
    orl_weather_done(&wea);
}

/* Each of four rows an hour stands for a quarter, for any value of its minute field. */
static void test_quarters(void **state)
{
    static const char row[] = "2020,3,22,%d,%d,f,9,7,87,101300,0,0,305,0,%d,120,0,0,0\n";
    (void)state;
    for (int first = 0; first <= 15; first += 15) {
        char text[2048] = LOCATION "DATA PERIODS,1,4,Data,Sunday,1/1,12/31\n";
        for (int i = 0; i < 8; i++)
            snprintf(text + strlen(text), sizeof text - strlen(text), row, 12 + i / 4,
                     first + 15 * (i % 4), i);
        struct orl_weather weather = parse_good(text);
        assert_int_equal(weather.n_rows, 8);
        for (int i = 0; i < 8; i++) {
            assert_true(weather.rows[i].hour == 11.125 + 0.25 * i);
            assert_true(weather.rows[i].direct == i);
        }
        assert_true(weather.interval_h == 0.25);
        orl_weather_done(&weather);
    }
}

/* A file of two years is refused, with the years and the remedy; typical years, whose months are
 * of several years, are not. Two rows of the same time are refused in any file. */
static void test_two_years(void **state)
{
    static const char row[] = "%d,%d,22,12,0,f,9,7,87,101300,0,0,305,0,800,120,0,0,0\n";
    static const struct {
        int year, month, code;
    } second[] = {
        {2021, 3, ORL_ERR_RANGE}, {2021, 4, 0}, {2020, 3, ORL_ERR_RANGE}, {0, 3, ORL_ERR_RANGE}};
    (void)state;
    for (size_t i = 0; i < sizeof second / sizeof *second; i++) {
        char text[1024], rows[2][200];
        struct orl_weather weather = {0};
        struct orl_error err = {0};
        snprintf(rows[0], sizeof rows[0], row, 2020, 3);
        snprintf(rows[1], sizeof rows[1], row, second[i].year, second[i].month);
        snprintf(text, sizeof text, "%s%s%s", EPW, rows[0], rows[1]);
        assert_int_equal(parse(text, &weather, &err), second[i].code);
        if (second[i].code < 0)
            assert_int_equal(err.line, 4);
        if (i == 0) {
            assert_non_null(strstr(err.message, "2020 and of 2021"));
            assert_non_null(strstr(err.hint, "\"year\": 2020"));
        } else if (second[i].code < 0) {
            assert_non_null(strstr(err.message, "lines 3 and 4 have the same time"));
        }
        orl_weather_done(&weather);
    }
}

/* The chosen one of several years is used, with its own weekdays: 1 January 2021 was a Friday. */
static void test_chosen_year(void **state)
{
    static const char text[] = EPW "2020,3,22,12,0,f,9,7,87,101300,0,0,305,0,800,120,0,0,0\n"
                                   "2021,3,22,12,0,f,9,7,87,101300,0,0,305,0,500,150,0,0,0\n"
                                   "2022,3,22,12,0,f,9,7,87,101300,0,0,305,0,300,170,0,0,0\n";
    struct orl_weather weather = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_weather_parse("x", text, strlen(text), 2021, &weather, &err), 0);
    assert_int_equal(weather.n_rows, 1);
    assert_true(weather.rows[0].year == 2021 && weather.rows[0].direct == 500);
    assert_int_equal(weather.first_weekday, 4);
    orl_weather_done(&weather);
    assert_int_equal(orl_weather_parse("x", text, strlen(text), 2019, &weather, &err),
                     ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "no rows for 2019: its years are 2020 to 2022"));
    const char wea[] = WEA "3 22 11.500 800 120\n";
    assert_int_equal(orl_weather_parse("x", wea, strlen(wea), 2021, &weather, &err),
                     ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "rows of WEA files have no year"));
}

/* Rows of a file from July to June are sorted by calendar date. 1 July 2019 was a Monday, 1
 * January 2020 a Wednesday. */
static void test_july_to_june(void **state)
{
    static const char row[] = "%d,%d,%d,12,0,f,9,7,87,101300,0,0,305,0,800,120,0,0,0\n";
    static const int dates[][3] = {{2019, 7, 1}, {2019, 12, 31}, {2020, 1, 1}, {2020, 6, 30}};
    static const int months[] = {1, 6, 7, 12};
    char text[1024] = LOCATION "DATA PERIODS,1,1,Data,Monday, 7/ 1, 6/30\n";
    (void)state;
    for (size_t i = 0; i < 4; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), row, dates[i][0], dates[i][1],
                 dates[i][2]);
    struct orl_weather weather = parse_good(text);
    assert_int_equal(weather.n_rows, 4);
    assert_int_equal(weather.n_moved, 2);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(weather.rows[i].month, months[i]);
        assert_int_equal(weather.rows[i].year, i < 2 ? 2020 : 2019);
    }
    assert_int_equal(weather.first_weekday, 2);
    orl_weather_done(&weather);
    /* Overlapping times are not of one year. */
    struct orl_weather wea = {0};
    struct orl_error err = {0};
    assert_int_equal(parse(WEA "7 1 11.5 1 1\n1 1 11.5 1 1\n7 1 11.5 2 2\n", &wea, &err),
                     ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "lines 7 and 9 have the same time: month 7, day 1"));
}

/* DAYSIM writes 24.25 for a quarter past midnight, also on 31 December; other programs write 24. */
static void test_past_midnight(void **state)
{
    static const struct {
        const char *rows;
        int month, day;
    } cases[] = {{"3 22 24.25 7 1\n", 3, 23},
                 {"2 28 24.25 7 1\n", 3, 1},
                 {"2 28 24.25 7 1\n2 29 12 1 1\n", 2, 29},
                 {"12 31 24.25 7 1\n", 1, 1},
                 {"1 1 0.75 1 1\n12 31 23.75 1 1\n12 31 24.25 7 1\n", 1, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", WEA, cases[i].rows);
        struct orl_weather weather = parse_good(text);
        const struct orl_weather_row *row = &weather.rows[0];
        assert_true(row->direct == 7 && row->hour == 0.25);
        assert_true(row->month == cases[i].month && row->day == cases[i].day);
        orl_weather_done(&weather);
    }
    struct orl_weather at_midnight = parse_good(WEA "3 22 23 1 1\n3 22 24 7 1\n");
    assert_true(at_midnight.rows[1].hour == 0 && at_midnight.rows[1].day == 23);
    orl_weather_done(&at_midnight);
    struct orl_weather none;
    struct orl_error err = {0};
    assert_int_equal(parse(WEA "3 22 25.5 7 1\n", &none, &err), ORL_ERR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_both_formats_agree), cmocka_unit_test(test_fixtures),
        cmocka_unit_test(test_nearest_row),        cmocka_unit_test(test_missing_values),
        cmocka_unit_test(test_half_hour_zone),     cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_every_truncation),   cmocka_unit_test(test_weekday_and_year),
        cmocka_unit_test(test_two_years),          cmocka_unit_test(test_chosen_year),
        cmocka_unit_test(test_july_to_june),       cmocka_unit_test(test_past_midnight),
        cmocka_unit_test(test_hours_from_zero),    cmocka_unit_test(test_quarters),
        cmocka_unit_test(test_other_forms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
