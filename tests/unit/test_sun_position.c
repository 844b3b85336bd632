/*
 * Position of the sun, against published values and a second algorithm. The second algorithm takes
 * the Earth's motion from the largest terms of VSOP87 (Bretagnon and Francou 1988), as Meeus
 * prints them in "Astronomical Algorithms" (appendix III). The code under test uses mean elements.
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
#include "scene/generate/sky/sun.h"

static const double deg = ORL_PI / 180;

static struct orl_location site_at(double latitude, double longitude_east, double zone_h)
{
    return (struct orl_location){latitude * deg, -longitude_east * deg, -15 * zone_h * deg};
}

/* ---- Published values ------------------------------------------------------------------------ */

/* Returns the refraction by air, Reda and Andreas 2004 (NREL/TP-560-34302), equation 42. */
static double refraction_deg(double altitude_deg, double pressure_mbar, double temperature_c)
{
    return pressure_mbar / 1010 * 283 / (273 + temperature_c) * 1.02 /
           (60 * tan((altitude_deg + 10.3 / (altitude_deg + 5.11)) * deg));
}

/* The report's table A5.1: 17 October 2003, 12:30:30 at UTC - 7, 820 mbar, 11 degrees Celsius. */
static void test_report(void **state)
{
    const struct orl_location site = site_at(39.742476, -105.1786, -7);
    const struct orl_moment moment = {.year = 2003, .month = 10, .day = 17, .hour = 12 + 30.5 / 60};
    const struct orl_sun_position sun = orl_sun_accurate(&site, &moment);
    const double altitude = sun.altitude_rad / deg;
    const double zenith = 90 - altitude - refraction_deg(altitude, 820, 11);
    const double azimuth = 180 + sun.azimuth_rad / deg;
    (void)state;
    print_message("# zenith %.5f, azimuth %.5f\n", zenith, azimuth);
    assert_true(fabs(zenith - 50.11162) < 0.002);
    assert_true(fabs(azimuth - 194.34024) < 0.002);
}

/* Meeus, example 25.b: 13 October 1992, 0 h dynamical time; declination -7 47 01.74. Seen from the
 * pole, where altitude is declination minus parallax. */
static void test_meeus(void **state)
{
    const struct orl_location pole = site_at(90, 0, 0);
    const struct orl_moment moment = {.year = 1992, .month = 10, .day = 13, .hour = -59.0 / 3600};
    const double parallax = 8.794 / 3600;
    const double declination =
        orl_sun_accurate(&pole, &moment).altitude_rad / deg + parallax * cos(7.78 * deg);
    (void)state;
    assert_true(fabs(declination + 7 + 47.0 / 60 + 1.74 / 3600) < 0.002);
}

/* ---- A second algorithm ---------------------------------------------------------------------- */

struct term {
    double size, phase, rate; /* 1e-8, rad, rad in a thousand years */
};

static double sum_of(const struct term *terms, size_t count, double t)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += terms[i].size * cos(terms[i].phase + terms[i].rate * t);
    return 1e-8 * sum;
}

/* Returns the Earth's heliocentric longitude in radians, for the mean equinox of the date. */
static double earth_longitude(double t)
{
    static const struct term l0[] = {{175347046, 0, 0},           {3341656, 4.6692568, 6283.07585},
                                     {34894, 4.6261, 12566.1517}, {3497, 2.7441, 5753.3849},
                                     {3418, 2.8289, 3.5231},      {3136, 3.6277, 77713.7715},
                                     {2676, 4.4181, 7860.4194},   {2343, 6.1352, 3930.2097},
                                     {1324, 0.7425, 11506.7698},  {1273, 2.0371, 529.691},
                                     {1199, 1.1096, 1577.3435},   {990, 5.233, 5884.927},
                                     {902, 2.045, 26.298},        {857, 3.508, 398.149},
                                     {780, 1.179, 5223.694},      {753, 2.533, 5507.553},
                                     {505, 4.583, 18849.228},     {492, 4.205, 775.523},
                                     {357, 2.92, 0.067},          {317, 5.849, 11790.629},
                                     {284, 1.899, 796.298},       {271, 0.315, 10977.079}};
    static const struct term l1[] = {{628331966747, 0, 0},
                                     {206059, 2.678235, 6283.07585},
                                     {4303, 2.6351, 12566.1517},
                                     {425, 1.59, 3.523}};
    static const struct term l2[] = {{52919, 0, 0}, {8720, 1.0721, 6283.0758}};
    return sum_of(l0, sizeof l0 / sizeof *l0, t) + t * sum_of(l1, sizeof l1 / sizeof *l1, t) +
           t * t * sum_of(l2, sizeof l2 / sizeof *l2, t);
}

/* Returns a Julian day by counting days, independently of the formula under test. */
static double julian_day(int year, int month, int day, double hour_ut)
{
    static const int lengths[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    double days = 2433282.5; /* 1 January 1950, 0 h */
    for (int y = 1950; y < year; y++)
        days += (y % 4 == 0 && y % 100 != 0) || y % 400 == 0 ? 366 : 365;
    for (int m = 1; m < month; m++)
        days += lengths[m - 1] + (m == 2 && year % 4 == 0 && (year % 100 != 0 || year % 400 == 0));
    return days + day - 1 + hour_ut / 24;
}

/* Terrestrial minus universal time, seconds: Espenak and Meeus 2006, at decades, then by their
 * prediction. */
static double delta_t(double year)
{
    static const double at[] = {29, 33.2, 40.2, 50.5, 56.9, 63.8, 66.1, 69.4};
    const double place = (year - 1950) / 10;
    const int i = (int)place;
    return i >= 7 ? 69.4 : at[i] + (place - i) * (at[i + 1] - at[i]);
}

/* Returns the direction to the sun, x east, y north, z up, by rotations of vectors; parallax
 * included. */
static struct orl_vec3 second_opinion(double latitude, double longitude_east, int year, int month,
                                      int day, double hour_ut)
{
    const double jd = julian_day(year, month, day, hour_ut);
    const double tau = (jd + delta_t(year) / 86400 - 2451545) / 365250, t = 10 * tau;
    const double node = (125.04452 - 1934.136261 * t) * deg;
    const double sun_mean = (280.4665 + 36000.7698 * t) * deg;
    const double moon_mean = (218.3165 + 481267.8813 * t) * deg;
    const double psi = (-17.20 * sin(node) - 1.32 * sin(2 * sun_mean) - 0.23 * sin(2 * moon_mean) +
                        0.21 * sin(2 * node)) /
                       3600 * deg;
    const double epsilon = (9.20 * cos(node) + 0.57 * cos(2 * sun_mean) +
                            0.10 * cos(2 * moon_mean) - 0.09 * cos(2 * node)) /
                           3600 * deg;
    const double tilt = (84381.448 - 46.8150 * t - 0.00059 * t * t) / 3600 * deg + epsilon;
    const double distance = 1.00014 + 0.01671 * cos(3.0984635 + 6283.07585 * tau);
    const double lambda = earth_longitude(tau) + ORL_PI + psi - 20.4898 / 3600 / distance * deg;
    const double days = jd - 2451545;
    const double sidereal = fmod(280.46061837 + 360.98564736629 * days, 360) * deg +
                            psi * cos(tilt) + longitude_east * deg;
    const struct orl_vec3 e = {cos(lambda), sin(lambda) * cos(tilt), sin(lambda) * sin(tilt)};
    const double s = sin(sidereal), c = cos(sidereal), n = sin(latitude * deg);
    const double towards_meridian = c * e.x + s * e.y, m = cos(latitude * deg);
    const double earth_radius = 8.794 / 3600 * deg / distance;
    return orl_normalize(orl_v3(c * e.y - s * e.x, m * e.z - n * towards_meridian,
                                n * e.z + m * towards_meridian - earth_radius));
}

/* Returns a low-discrepancy number, by powers of the plastic number. */
static double spread_number(int i, int axis)
{
    static const double steps[] = {0.8191725134, 0.6710436067, 0.5497004779, 0.4503012030};
    const double x = 0.5 + (i + 1) * steps[axis];
    return x - floor(x);
}

/* 5000 times of 1950 to 2099 at places all over the Earth. */
static void test_against_second(void **state)
{
    double worst = 0, sum = 0;
    enum { CASES = 5000 };
    (void)state;
    for (int i = 0; i < CASES; i++) {
        const double latitude = 180 * spread_number(i, 0) - 90,
                     longitude = 360 * spread_number(i, 1) - 180;
        const double zone = round(longitude / 15), date = 150 * spread_number(i, 2);
        const int year = 1950 + (int)date, month = 1 + i % 12, day = 1 + i / 12 % 28;
        const double hour = 24 * spread_number(i, 3);
        const struct orl_location site = site_at(latitude, longitude, zone);
        const struct orl_moment moment = {.year = year, .month = month, .day = day, .hour = hour};
        const struct orl_sun_position sun = orl_sun_accurate(&site, &moment);
        const struct orl_vec3 a = orl_sun_direction(&sun);
        const struct orl_vec3 b =
            second_opinion(latitude, longitude, year, month, day, hour - zone);
        const double off = orl_length(orl_sub(a, b)) / deg;
        worst = fmax(worst, off);
        sum += off * off;
    }
    print_message("# %d times and places: at most %.4f degrees apart, %.4f as mean square\n", CASES,
                  worst, sqrt(sum / CASES));
    assert_true(worst < 0.005);
}

/* The second algorithm against the report's intermediate values. */
static void test_second(void **state)
{
    const double jd = julian_day(2003, 10, 17, 19 + 30.5 / 60);
    const double longitude =
        fmod(earth_longitude((jd + 67.0 / 86400 - 2451545) / 365250) / deg, 360);
    const struct orl_vec3 sun = second_opinion(39.742476, -105.1786, 2003, 10, 17, 19 + 30.5 / 60);
    (void)state;
    assert_true(fabs(jd - 2452930.312847) < 1e-6);
    assert_true(fabs(longitude - 24.0182616917) < 0.001);
    assert_true(fabs(atan2(-sun.x, -sun.y) / deg - 14.34024) < 0.001);
}

/* A time without a year is in 2017, and 29 February in 2016; so are years that the formulas do not
 * cover. Midnight is continuous: 24 h is the next day's 0 h. */
static void test_years(void **state)
{
    const struct orl_location site = site_at(50, 8, 1);
    static const struct {
        struct orl_moment asked, same;
    } cases[] = {{{.month = 3, .day = 1, .hour = 9}, {2017, 3, 1, 9, false}},
                 {{.month = 2, .day = 29, .hour = 9}, {2016, 2, 29, 9, false}},
                 {{1899, 6, 2, 9, false}, {2017, 6, 2, 9, false}},
                 {{9999, 6, 2, 9, false}, {2017, 6, 2, 9, false}},
                 {{2020, 2, 28, 24, false}, {2020, 2, 29, 0, false}},
                 {{2021, 12, 31, 24, false}, {2022, 1, 1, 0, false}}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_sun_position a = orl_sun_accurate(&site, &cases[i].asked);
        const struct orl_sun_position b = orl_sun_accurate(&site, &cases[i].same);
        assert_true(fabs(a.altitude_rad - b.altitude_rad) < 1e-12);
        assert_true(fabs(a.azimuth_rad - b.azimuth_rad) < 1e-12);
        assert_true(a.solar_hour >= 0 && a.solar_hour < 24);
    }
}

/* ---- Rows of weather files ------------------------------------------------------------------- */

static struct orl_daylight row_sky(const char *text, enum orl_sun_method method)
{
    struct orl_weather weather;
    struct orl_daylight sky = {0};
    struct orl_error err = {0};
    double diffuse;
    if (orl_weather_parse("w", text, strlen(text), 0, &weather, &err) < 0)
        fail_msg("%s", err.message);
    weather.sun_method = method;
    if (orl_daylight_from_row(&weather, &weather.rows[0], &sky, &diffuse, &err) < 0)
        fail_msg("%s", err.message);
    orl_weather_done(&weather);
    return sky;
}

static double apart_deg(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_length(orl_sub(a, b)) / deg;
}

/* An EPW row of hour 12 is at 11.5; its year matters: 0.2 degrees at an equinox. */
static void test_row_of_a_year(void **state)
{
    (void)state;
    for (int year = 1981; year <= 2024; year++) {
        char text[400];
        snprintf(text, sizeof text,
                 "LOCATION,a,b,c,d,e,60.17,24.94,2.0,25\nDATA PERIODS,1,1,Data,Sunday,3/21,3/21\n"
                 "%d,3,21,12,0,f,0,0,0,0,0,0,0,0,600,80,0\n",
                 year);
        const struct orl_vec3 wanted = second_opinion(60.17, 24.94, year, 3, 21, 9.5);
        assert_true(apart_deg(row_sky(text, ORL_SUN_ACCURATE).sun, wanted) < 0.005);
        assert_true(apart_deg(row_sky(text, ORL_SUN_RADIANCE).sun, wanted) > 0.3);
    }
}

/* With the RADIANCE method the sun is gendaylit's. */
static void test_radiance(void **state)
{
    static const char wea[] = "place a\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                              "site_elevation 0\nweather_data_file_units 1\n3 22 11.5 800 120\n";
    const struct orl_location site = site_at(38.42, 27.14, 2);
    const struct orl_moment moment = {.month = 3, .day = 22, .hour = 11.5};
    double declination, hour;
    (void)state;
    orl_sun_clock(&site, &moment, &declination, &hour);
    const struct orl_sun_position sun = orl_sun_at(&site, declination, hour);
    assert_true(apart_deg(row_sky(wea, ORL_SUN_RADIANCE).sun, orl_sun_direction(&sun)) < 1e-9);
    assert_true(apart_deg(row_sky(wea, ORL_SUN_ACCURATE).sun,
                          second_opinion(38.42, 27.14, 2017, 3, 22, 9.5)) < 0.005);
}

/* Quito at an equinox: the sun itself stays above 87 degrees, the pattern's is at 87. */
static void test_zenith(void **state)
{
    static const char wea[] = "place a\nlatitude 0\nlongitude 78\ntime_zone 75\n"
                              "site_elevation 0\nweather_data_file_units 1\n3 20 12.3 900 90\n";
    const struct orl_vec3 wanted = second_opinion(0, -78, 2017, 3, 20, 17.3);
    const struct orl_daylight sky = row_sky(wea, ORL_SUN_ACCURATE);
    (void)state;
    assert_true(asin(wanted.z) > 88.5 * deg);
    assert_true(apart_deg(sky.sun, wanted) < 0.005);
    assert_true(fabs(sky.pattern.a[9] - sin(87 * deg)) < 1e-9);
    assert_string_equal(sky.warnings, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_report),   cmocka_unit_test(test_meeus),
        cmocka_unit_test(test_second),   cmocka_unit_test(test_against_second),
        cmocka_unit_test(test_years),    cmocka_unit_test(test_row_of_a_year),
        cmocka_unit_test(test_radiance), cmocka_unit_test(test_zenith),
    };
    return cmocka_run_group_tests_name("sun_position", tests, NULL, NULL);
}
