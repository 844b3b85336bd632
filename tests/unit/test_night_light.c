/*
 * Rows of weather files against the sun: places at the date line, the Arctic, light at night, and
 * global irradiance that reveals a shift of times.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "light/daylight/daylight.h"
#include "light/daylight/weather.h"
#include "scene/generate/generate.h"

enum { YEAR_ROWS = 8760 };

struct place {
    const char *name;
    double latitude_deg, longitude_deg, time_zone_h;
};

static const struct place tromso = {"Tromso", 69.65, 18.95, 1},
                          athens = {"Athens", 37.98, 23.73, 2},
                          samoa = {"Samoa", -13.83, -171.77, 13},
                          denver = {"Denver", 39.74, -104.98, -7};

static double altitude_deg(const struct place *place, const struct orl_weather_row *row)
{
    const struct orl_location site = {place->latitude_deg * ORL_DEG_TO_RAD,
                                      -place->longitude_deg * ORL_DEG_TO_RAD,
                                      -15 * place->time_zone_h * ORL_DEG_TO_RAD};
    const struct orl_moment moment = {0, row->month, row->day, row->hour, false};
    return orl_sun_accurate(&site, &moment).altitude_rad / ORL_DEG_TO_RAD;
}

/* Sets the row to the means of twelve clear moments of an hour, W/m2. */
static void shine(const struct place *place, struct orl_weather_row *row)
{
    enum { MOMENTS = 12 };
    for (int i = 0; i < MOMENTS; i++) {
        struct orl_weather_row at = *row;
        at.hour += (i + 0.5) / MOMENTS - 0.5;
        const double up = sin(altitude_deg(place, &at) * ORL_DEG_TO_RAD);
        const double direct = up > 0 ? 900 * up / (up + 0.15) / MOMENTS : 0;
        const double diffuse = up > 0 ? (20 + 80 * up) / MOMENTS : 0;
        row->direct += direct;
        row->diffuse += diffuse;
        row->global += direct * up + diffuse;
    }
}

/* Returns a year of clear hours of a place, which a test may then give another site or shifted
 * times. */
static struct orl_weather clear_year(const struct place *place)
{
    static struct orl_weather_row rows[YEAR_ROWS];
    static const int lengths[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    size_t n = 0;
    for (int month = 1; month <= 12; month++)
        for (int day = 1; day <= lengths[month - 1]; day++)
            for (int hour = 0; hour < 24; hour++) {
                rows[n] = (struct orl_weather_row){
                    .month = month, .day = day, .hour = hour + 0.5, .line = (int)n + 9};
                shine(place, &rows[n++]);
            }
    return (struct orl_weather){.latitude_deg = place->latitude_deg,
                                .longitude_deg = place->longitude_deg,
                                .time_zone_h = place->time_zone_h,
                                .units = ORL_WEATHER_NORMAL_W,
                                .interval_h = 1,
                                .rows = rows,
                                .n_rows = n};
}

static struct orl_daylight sky_of(const struct orl_weather *weather, size_t row)
{
    struct orl_daylight sky = {0};
    struct orl_error err = {0};
    double diffuse;
    if (orl_daylight_from_row(weather, &weather->rows[row], &sky, &diffuse, &err) < 0)
        fail_msg("%s", err.message);
    return sky;
}

/* Counts rows that have light but a black sky. */
static size_t count_dark(const struct orl_weather *weather, double least_w)
{
    size_t dark = 0;
    for (size_t i = 0; i < weather->n_rows; i++) {
        const struct orl_weather_row *row = &weather->rows[i];
        if (row->direct + row->diffuse > least_w)
            dark += sky_of(weather, i).black;
    }
    return dark;
}

/* ---- The Arctic ------------------------------------------------------------------------------ */

/* Hours in which the sun is up only in part have light. By Radiance's fit and the middle of the
 * hour, some hundred are dark. */
static void test_arctic(void **state)
{
    struct orl_weather weather = clear_year(&tromso);
    (void)state;
    assert_int_equal(count_dark(&weather, 0), 0);
    weather.sun_method = ORL_SUN_RADIANCE;
    print_message("# dark by Radiance's fit: %zu\n", count_dark(&weather, 0));
    assert_true(count_dark(&weather, 0) > 100);
}

/* For such an hour the sun is at the middle of the part in which it is up: above the horizon, at a
 * time of the row's hour. Rows of ten minutes stay within theirs. */
static void test_part_of_an_hour(void **state)
{
    struct orl_weather_row row = {.month = 3, .day = 21, .direct = 30, .diffuse = 10, .line = 9};
    const struct orl_weather weather = {.latitude_deg = 37.98,
                                        .longitude_deg = 23.73,
                                        .time_zone_h = 2,
                                        .units = ORL_WEATHER_NORMAL_W,
                                        .interval_h = 1,
                                        .rows = &row,
                                        .n_rows = 1};
    struct orl_weather short_rows = weather;
    (void)state;
    short_rows.interval_h = 1.0 / 6;
    /* The sun starts 2 degrees below: it rises within ten minutes, some 4 degrees an hour in
     * azimuth and 12 in altitude. */
    row.hour = 6;
    while (altitude_deg(&athens, &row) < -2)
        row.hour += 1.0 / 600;
    const double later_deg = orl_daylight_altitude_of_row(&weather, &row);
    assert_true(later_deg > 0.5 && later_deg < 3);
    assert_false(sky_of(&weather, 0).black);
    assert_true(orl_daylight_altitude_of_row(&short_rows, &row) < -1.9);
    assert_true(sky_of(&short_rows, 0).black);
}

/* ---- The date line --------------------------------------------------------------------------- */

/* By either sun method, light is as elsewhere, without a warning about the site. */
static void test_date_line(void **state)
{
    static const struct place places[] = {
        {"Samoa", -13.83, -171.77, 13},    {"Tonga", -21.14, -175.2, 13},
        {"Kiritimati", 1.87, -157.43, 14}, {"Chatham", -43.95, -176.56, 12.75},
        {"Fiji", -18.14, 178.44, 12},      {"Baker Island", 0.2, -176.48, -12}};
    (void)state;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        struct orl_weather weather = clear_year(&places[i]);
        size_t lit = 0;
        for (int method = ORL_SUN_ACCURATE; method <= ORL_SUN_RADIANCE; method++) {
            weather.sun_method = (enum orl_sun_method)method;
            /* With the RADIANCE method, hours in which the sun rises in the second half are dark.
             */
            if (count_dark(&weather, method == ORL_SUN_RADIANCE ? 300 : 0) > 0)
                fail_msg("%s: dark", places[i].name);
            for (size_t k = 0; k < 48; k++) {
                const struct orl_daylight sky = sky_of(&weather, k);
                assert_null(strstr(sky.warnings, "time zone differ by"));
                lit += !sky.black;
            }
        }
        assert_in_range(lit, 44, 68); /* two days, two methods */
    }
}

/* Commands in scenes accept such time zones too, and still warn of a wrong sign. */
static void test_commands(void **state)
{
    static const char *const samoan[] = {"gendaylit", "1",  "15",   "12.5", "-a",  "-13.83", "-o",
                                         "171.77",    "-m", "-195", "-W",   "700", "100"};
    static const char *const wrong[] = {"gensky", "1",  "15",   "12.5", "-a",
                                        "40",     "-o", "-105", "-m",   "105"};
    struct orl_text text = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_gendaylit(samoan, 13, &text, &err), 0);
    assert_string_equal(text.warnings, "");
    assert_null(strstr(text.data, "10 0 0 0"));
    orl_text_done(&text);
    text = (struct orl_text){0};
    assert_int_equal(orl_gensky(wrong, 10, &text, &err), 0);
    assert_non_null(strstr(text.warnings, "time zone differ by 10.0 hours"));
    orl_text_done(&text);
}

/* ---- Light at night -------------------------------------------------------------------------- */

static struct orl_night_light find_night_light(const struct orl_weather *weather, char *text,
                                               size_t size)
{
    const struct orl_night_light night = orl_night_light_find(weather);
    text[0] = '\0';
    orl_night_light_describe(&night, text, size);
    print_message("# %s\n", text[0] ? text : "nothing");
    return night;
}

/* The result against a count of the rows. */
static void test_count(void **state)
{
    static const struct place elsewhere = {"wrong sign", 39.74, 104.98, -7};
    struct orl_weather weather = clear_year(&denver);
    char text[640];
    double lost = 0, total = 0;
    size_t n = 0;
    (void)state;
    assert_int_equal(find_night_light(&weather, text, sizeof text).n_rows, 0);
    assert_string_equal(text, "");
    weather.longitude_deg = elsewhere.longitude_deg;
    for (size_t i = 0; i < weather.n_rows; i++) {
        const struct orl_weather_row *row = &weather.rows[i];
        const double light = row->direct + row->diffuse;
        total += light;
        if (light == 0 || !sky_of(&weather, i).black)
            continue;
        lost += light;
        n++;
    }
    const struct orl_night_light night = find_night_light(&weather, text, sizeof text);
    assert_int_equal(night.n_rows, n);
    assert_true(fabs(night.hours - (double)n) < 1e-9);
    assert_true(fabs(night.lost - lost) < 1e-6 * lost && fabs(night.total - total) < 1e-6 * total);
    assert_int_equal(night.cause, ORL_NIGHT_LONGITUDE);
    assert_non_null(strstr(text, "sign of the longitude"));
}

static void test_causes(void **state)
{
    struct orl_weather weather = clear_year(&athens);
    char text[640];
    (void)state;
    weather.time_zone_h = -2;
    assert_int_equal(find_night_light(&weather, text, sizeof text).cause, ORL_NIGHT_TIME_ZONE);
    assert_non_null(strstr(text, "sign of the time zone"));
    weather.time_zone_h = 2;
    for (int shift = -1; shift <= 1; shift += 2) {
        for (size_t i = 0; i < weather.n_rows; i++)
            weather.rows[i].hour += shift;
        const struct orl_night_light night = find_night_light(&weather, text, sizeof text);
        for (size_t i = 0; i < weather.n_rows; i++)
            weather.rows[i].hour -= shift;
        assert_int_equal(night.cause, ORL_NIGHT_SHIFT);
        assert_true(night.shift_h == -shift);
        assert_non_null(strstr(text, shift > 0 ? "1 h too late" : "1 h too early"));
    }
}

/* For quarter-hour rows a shift of half an hour is reported: it exceeds the correction for a part
 * of an hour. */
static void test_half_an_hour(void **state)
{
    struct orl_weather weather = clear_year(&samoa);
    char text[640];
    (void)state;
    weather.interval_h = 0.25;
    for (size_t i = 0; i < weather.n_rows; i++) {
        weather.rows[i].direct = weather.rows[i].diffuse = 0;
        if (altitude_deg(&samoa, &weather.rows[i]) > 0)
            weather.rows[i].direct = 300;
        weather.rows[i].hour += 0.5;
    }
    assert_true(fabs(find_night_light(&weather, text, sizeof text).shift_h + 0.5) < 1e-9);
    assert_non_null(strstr(text, "0.5 h too late"));
}

/* The warning of a single sky states the light that it leaves out. */
static void test_single_sky(void **state)
{
    struct orl_weather weather = clear_year(&athens);
    struct orl_daylight sky;
    (void)state;
    weather.rows[1].direct = 120;
    weather.rows[1].diffuse = 30;
    sky = sky_of(&weather, 1);
    assert_true(sky.black);
    assert_non_null(strstr(sky.warnings, "120 W/m2 direct and 30 W/m2 diffuse are left out"));
    assert_non_null(strstr(sky.warnings, "longitude"));
    sky = sky_of(&weather, 2);
    assert_true(sky.black && !strstr(sky.warnings, "left out"));
}

/* ---- Shifts of times ------------------------------------------------------------------------- */

static void move_times(struct orl_weather *weather, double by_h)
{
    for (size_t i = 0; i < weather->n_rows; i++)
        weather->rows[i].hour += by_h;
}

/* contradicts: true if no shift reconciles the file's numbers; the text then says so. */
static struct orl_time_shift find_shift(const struct orl_weather *weather, bool contradicts,
                                        char *text, size_t size)
{
    const struct orl_time_shift shift = orl_time_shift_find(weather);
    text[0] = '\0';
    assert_int_equal(orl_time_shift_describe(&shift, text, size),
                     shift.shift_h != 0 || contradicts);
    assert_int_equal(strstr(text, "contradict each other") != NULL, contradicts);
    if (text[0])
        print_message("# %s\n", text);
    return shift;
}

/* Half an hour either way, and 42 minutes as in files of PVGIS: the time zone in the warning
 * removes the shift. */
static void test_shifted_times(void **state)
{
    static const struct place *const places[] = {&tromso, &athens, &samoa, &denver};
    static const double shifts_h[] = {0, -0.5, 0.5, 0.7};
    char text[640];
    (void)state;
    for (size_t p = 0; p < sizeof places / sizeof *places; p++)
        for (size_t i = 0; i < sizeof shifts_h / sizeof *shifts_h; i++) {
            struct orl_weather weather = clear_year(places[p]);
            move_times(&weather, -shifts_h[i]);
            const struct orl_time_shift shift = find_shift(&weather, false, text, sizeof text);
            if (!(fabs(shift.shift_h - shifts_h[i]) < 0.11))
                fail_msg("%s: %g h, not %g", places[p]->name, shift.shift_h, shifts_h[i]);
            assert_true(shift.shift_h == 0 || strstr(text, shift.shift_h < 0 ? "late" : "early"));
            weather.time_zone_h -= shift.shift_h;
            assert_true(find_shift(&weather, false, text, sizeof text).shift_h == 0);
        }
}

/* No shift is found in WEA files, which have no global irradiance, nor if the global irradiance
 * fits no position of the sun. */
static void test_shifts_unknown(void **state)
{
    struct orl_weather weather = clear_year(&athens);
    char text[640];
    (void)state;
    for (size_t i = 0; i < weather.n_rows; i++)
        weather.rows[i].global = i % 2 ? 900 : 50;
    assert_true(find_shift(&weather, true, text, sizeof text).shift_h == 0);
    move_times(&weather, 0.5);
    for (size_t i = 0; i < weather.n_rows; i++)
        weather.rows[i].global = NAN;
    assert_true(find_shift(&weather, false, text, sizeof text).shift_h == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shifted_times), cmocka_unit_test(test_shifts_unknown),
        cmocka_unit_test(test_arctic),        cmocka_unit_test(test_part_of_an_hour),
        cmocka_unit_test(test_date_line),     cmocka_unit_test(test_commands),
        cmocka_unit_test(test_count),         cmocka_unit_test(test_causes),
        cmocka_unit_test(test_half_an_hour),  cmocka_unit_test(test_single_sky),
    };
    return cmocka_run_group_tests_name("night_light", tests, NULL, NULL);
}
