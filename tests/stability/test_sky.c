/*
 * Hard cases of skies and weather: polar day and night, borders of the Perez model, no diffuse
 * light, gaps in a year's file, the horizon. Skies that jobs request go through
 * orl_daylight_from_request or whole jobs; skies in scenes go through the parser.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "light/daylight/daylight.h"
#include "scene/generate/sky/sky_models.h"
#include "support/scene_text.h"
#include "support/stability.h"

static const int month_days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

static struct orl_sky_request request_at(double altitude_deg, double direct, double diffuse)
{
    return (struct orl_sky_request){.model = ORL_SKY_BY_PEREZ,
                                    .sun_given = true,
                                    .sun_altitude_deg = altitude_deg,
                                    .sun_azimuth_deg = 25,
                                    .first = direct,
                                    .second = diffuse,
                                    .ground_reflectance = 0.2,
                                    .turbidity = 2.45,
                                    .direct_normal_lx = -1};
}

/* Checks all values of the daylight, and the brightness in all directions and near the horizon. */
static bool is_finite(const struct orl_daylight *d)
{
    bool good = isfinite(d->sun.x) && isfinite(d->sun.y) && isfinite(d->sun.z) &&
                isfinite(d->sun_radiance) && d->sun_radiance >= 0 && isfinite(d->sun_angle_deg);
    for (int i = 0; i < 400 && good && !d->black; i++) {
        const double z = i < 200 ? i / 100.0 - 1 + 0.005 : (i - 300) * 1e-4, r = sqrt(1 - z * z);
        const double value =
            orl_sky_brightness(&d->pattern, orl_v3(r * cos(2.4 * i), r * sin(2.4 * i), z));
        good = isfinite(value) && value >= 0;
    }
    return good;
}

/* ---- 6: polar day and night ------------------------------------------------------------------ */

static const double latitudes[] = {67, 75, 85, 89.9999, 90};

static struct orl_sky_request polar(int latitude, int south, int month, double hour)
{
    struct orl_sky_request r = request_at(0, 400, 120);
    r.sun_given = false;
    r.time_given = true;
    r.latitude_deg = south ? -latitudes[latitude] : latitudes[latitude];
    r.month = month;
    r.day = 21;
    r.hour = hour;
    r.normalise = ORL_SKY_GENDAYLIT; /* the fastest; the flux is not tested here */
    return r;
}

/* Perez and both CIE skies with a sun, each month and hour; at the poles the sun moves in circles.
 */
static void test_06_polar(void **state)
{
    const double step = stability_full() ? 0.25 : 2;
    long odd = 0, bright_nights = 0;
    double wobble = 0;
    (void)state;
    for (int l = 0; l < 10; l++) {
        for (int month = 1; month <= 12; month++) {
            double low = 90, high = -90;
            for (double hour = 0; hour < 24; hour += step) {
                struct orl_sky_request r = polar(l % 5, l > 4, month, hour);
                struct orl_daylight d = {0};
                for (int kind = 0; kind < 3; kind++) {
                    r.model = kind ? ORL_SKY_BY_CIE : ORL_SKY_BY_PEREZ;
                    r.cie_type = kind == 1 ? ORL_SKY_CLEAR : ORL_SKY_INTERMEDIATE;
                    r.input = kind ? ORL_SKY_TYPICAL : ORL_SKY_NORMAL_W;
                    odd += orl_daylight_from_request(&r, NULL, &d, NULL) < 0 || !is_finite(&d);
                    bright_nights += d.sun.z < 0 && !(d.black && d.warnings[0]);
                }
                low = fmin(low, asin(d.sun.z) / ORL_DEG_TO_RAD);
                high = fmax(high, asin(d.sun.z) / ORL_DEG_TO_RAD);
            }
            if (l % 5 == 4)
                wobble = fmax(wobble, high - low);
        }
    }
    stability_row(6, "polar day and night", "skies with a number that is not finite", (double)odd,
                  0);
    stability_row(6, "polar day and night",
                  "skies with the sun down that are not black, and say so", (double)bright_nights,
                  0);
    stability_row(6, "polar day and night", "height of the sun over a day at the pole: range, deg",
                  wobble, 1e-6);
}

/* ---- 7: borders of the Perez bins ------------------------------------------------------------ */

/*
 * Indices on each border, slightly below it and slightly above; also at the ends of the model's
 * range. Indices that imply more sun than is possible give a black sky with a warning.
 */
static void test_07_bin_borders(void **state)
{
    static const double borders[] = {1, 1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200, 12.009};
    static const double brightnesses[] = {0.01, 0.2, 0.6};
    int undefined = 0, odd = 0;
    (void)state;
    for (int i = 0; i < 9; i++) {
        for (int k = -1; k <= 1; k++) {
            const double clearness = k == 0 ? borders[i] : nextafter(borders[i], k * 100.0);
            const int bin = i == 8 ? 7 : k < 0 ? i - 1 : i;
            undefined += orl_perez_bin(clearness) != bin;
            if (clearness < 1 || clearness > 12.009)
                continue; /* jobs are refused for these */
            for (int b = 0; b < 9; b++) {
                struct orl_sky_request r =
                    request_at(20 + 30 * (b / 3), clearness, brightnesses[b % 3]);
                struct orl_daylight d = {0};
                r.input = ORL_SKY_INDICES;
                odd += orl_daylight_check(&r, NULL) < 0 ||
                       orl_daylight_from_request(&r, NULL, &d, NULL) < 0 || !is_finite(&d) ||
                       (d.black && !strstr(d.warnings, "exceeds the solar constant"));
            }
        }
    }
    stability_row(7, "Perez epsilon on a bin border", "borders that do not belong to the bin above",
                  undefined, 0);
    stability_row(7, "Perez epsilon on a bin border",
                  "skies there not finite, or black though they could be", odd, 0);
}

/* ---- 8: no diffuse light --------------------------------------------------------------------- */

static void test_08_sun_alone(void **state)
{
    static const double altitudes[] = {0.5, 5, 30, 60, 89};
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    double off = 0;
    int odd = 0;
    (void)state;
    for (int i = 0; i < 5; i++) {
        struct orl_sky_request r = request_at(altitudes[i], 50000, 0);
        struct orl_daylight d = {0};
        double lx;
        r.input = ORL_SKY_NORMAL_LX;
        r.ground_reflectance = 0;
        scene_run_lx(&(struct scene_run){.scene = "# nothing\n",
                                         .sky = &r,
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .samples = 16,
                                         .global = 1},
                     &lx);
        off = fmax(off, fabs(lx / (50000 * sin(altitudes[i] * ORL_DEG_TO_RAD)) - 1));
        for (int kind = ORL_SKY_NORMAL_W; kind <= ORL_SKY_HORIZONTAL_W; kind++) {
            r = request_at(altitudes[i], kind == ORL_SKY_HORIZONTAL_W ? 1 : 500, 0);
            r.input = (enum orl_sky_input)kind;
            odd += orl_daylight_from_request(&r, NULL, &d, NULL) < 0 || !is_finite(&d);
        }
    }
    stability_row(8, "diffuse = 0, DNI > 0", "|E / (DNI sin altitude) - 1|", off, 0.002);
    stability_row(8, "diffuse = 0, DNI > 0", "skies with a number that is not finite", odd, 0);
}

/* ---- 9: gaps in a year ----------------------------------------------------------------------- */

enum { HOURS = 8760 };

/* Rows whose two fields are replaced, and the expected outcome of each. */
enum fate { FATE_REFUSED, FATE_BLACK, FATE_WARNED };
static const struct plant {
    int row;
    const char *direct, *diffuse;
    enum fate fate;
} plants[] = {
    {3, "400", "120", FATE_BLACK},
    {12, "9999", "120", FATE_REFUSED},
    {1452, "400", "9999", FATE_REFUSED},
    {1453, "99999", "99999", FATE_REFUSED},
    {1454, "9999.0", "9999.0", FATE_REFUSED},
    {2604, "0", "0", FATE_BLACK},
    {3684, "0.0", "-0.0", FATE_BLACK},
    {3685, "-5", "120", FATE_WARNED},
    {4429, "-999", "-999", FATE_REFUSED},
    {5172, "1500", "120", FATE_REFUSED},
    {6037, "400", "5000", FATE_REFUSED},
    {8749, "1e5", "0", FATE_REFUSED},
};
enum { PLANTS = sizeof plants / sizeof *plants, HEADER = 2 };

/* Values that every reader must refuse: the whole file fails at that line. */
static const char *const broken[] = {"", " ", "nan", "inf", "1e400", "missing", "4 0", "0x1F"};

/* Returns a year at 47 degrees north: sun and sky by day, nothing by night. */
static char *make_year(int broken_row, const char *broken_word)
{
    char *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    int row = 0, plant = 0;
    assert_non_null(f);
    fputs("LOCATION,a,b,c,d,e,47.0,8.0,1.0,500\nDATA PERIODS,1,1,Data,Sunday,1/1,12/31\n", f);
    for (int month = 1; month <= 12; month++) {
        for (int day = 1; day <= month_days[month - 1]; day++) {
            for (int hour = 1; hour <= 24; hour++, row++) {
                const bool light = hour >= 9 && hour <= 16;
                const char *direct = light ? "400" : "0", *diffuse = light ? "120" : "0";
                if (plant < PLANTS && plants[plant].row == row) {
                    direct = plants[plant].direct;
                    diffuse = plants[plant++].diffuse;
                }
                if (row == broken_row)
                    diffuse = broken_word;
                fprintf(f, "2001,%d,%d,%d,0,f,0,0,0,0,0,0,0,0,%s,%s,0\n", month, day, hour, direct,
                        diffuse);
            }
        }
    }
    fclose(f);
    assert_int_equal(row, HOURS);
    return text;
}

static struct orl_sky_request request_of_row(const struct orl_weather_row *row)
{
    struct orl_sky_request r = request_at(0, 0, 0);
    r.model = ORL_SKY_BY_WEATHER;
    r.sun_given = false;
    r.time_given = true;
    r.month = row->month;
    r.day = row->day;
    r.hour = row->hour;
    return r;
}

/* Returns true if the row gives light, or is black with a warning, or is refused with its line. */
static bool is_reported(const struct orl_weather *weather, const struct orl_sky_request *request,
                        int line, enum fate *ret_fate, bool *ret_lit)
{
    struct orl_daylight d = {0};
    struct orl_error err = {0};
    const int code = orl_daylight_from_request(request, weather, &d, &err);
    *ret_lit = false;
    if (code < 0) {
        *ret_fate = FATE_REFUSED;
        return err.line == line;
    }
    *ret_lit = !d.black && orl_sky_brightness(&d.pattern, orl_v3(0, 0, 1)) > 0;
    *ret_fate = d.black ? FATE_BLACK : FATE_WARNED;
    return is_finite(&d) && (d.warnings[0] || (*ret_lit && d.sun_radiance > 0));
}

/* Reads all 8760 rows as the job does, with gendaylit's normalisation, which is fast. */
static void test_09_a_year_with_gaps(void **state)
{
    char *text = make_year(-1, NULL);
    struct orl_weather weather;
    long silent = 0, lit_hours = 0, wrong = 0;
    (void)state;
    assert_int_equal(orl_weather_parse("year.epw", text, strlen(text), 0, &weather, NULL), 0);
    assert_int_equal(weather.n_rows, HOURS);
    for (int row = 0, plant = 0; row < HOURS; row++) {
        struct orl_sky_request request = request_of_row(&weather.rows[row]);
        enum fate fate;
        bool lit;
        if (!stability_full())
            request.normalise = ORL_SKY_GENDAYLIT;
        silent += !is_reported(&weather, &request, row + 1 + HEADER, &fate, &lit);
        lit_hours += lit;
        if (plant < PLANTS && plants[plant].row == row)
            wrong += fate != plants[plant++].fate;
    }
    assert_true(lit_hours > 2900 && lit_hours < 2921);
    stability_row(9, "EPW zeros, 9999, missing",
                  "hours neither lit, nor black and warned, nor refused", (double)silent, 0);
    stability_row(9, "EPW zeros, 9999, missing", "planted rows that end otherwise than they should",
                  (double)wrong, 0);
    orl_weather_done(&weather);
    free(text);
}

/* Whole jobs with the replaced rows: each is refused with the row's line, or gives finite values
 * and a warning. */
static void test_09_jobs(void **state)
{
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    static char name[] = "year.epw";
    char *text = make_year(-1, NULL);
    struct orl_weather weather;
    int silent = 0;
    (void)state;
    assert_int_equal(orl_weather_parse(name, text, strlen(text), 0, &weather, NULL), 0);
    for (int i = 0; i < PLANTS; i++) {
        struct orl_sky_request request = request_of_row(&weather.rows[plants[i].row]);
        request.weather_file = name;
        const struct scene_run run = {.scene = "# nothing\n",
                                      .resource_name = name,
                                      .resource_text = text,
                                      .sky = &request,
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .samples = 16,
                                      .global = 1};
        if (plants[i].fate == FATE_REFUSED) {
            struct orl_error err = {0};
            scene_run_fails(&run, &err);
            silent += err.line != plants[i].row + 1 + HEADER || strcmp(err.file, name) != 0;
        } else {
            struct orl_result result = scene_run(&run);
            silent += result.n_warnings == 0 || !isfinite(result.illuminance_lx[0]);
            silent += plants[i].fate == FATE_BLACK && result.illuminance_lx[0] != 0;
            orl_result_done(&result);
        }
    }
    stability_row(9, "EPW zeros, 9999, missing",
                  "jobs at planted rows without error line or warning", silent, 0);
    orl_weather_done(&weather);
    free(text);
}

static void test_09_no_numbers(void **state)
{
    int unnoticed = 0;
    (void)state;
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        const int row = 700 * (int)i + 11;
        char *text = make_year(row, broken[i]);
        struct orl_weather weather;
        struct orl_error err = {0};
        const int code = orl_weather_parse("year.epw", text, strlen(text), 0, &weather, &err);
        if (code == 0)
            orl_weather_done(&weather);
        unnoticed += code == 0 || err.line != row + 1 + HEADER || strcmp(err.file, "year.epw") != 0;
        free(text);
    }
    stability_row(9, "EPW zeros, 9999, missing",
                  "files with a field that is no number, not refused", unnoticed, 0);
}

/* ---- 10: the horizon ------------------------------------------------------------------------- */

/* Every kind of sky from 89.9999 to 90 degrees and as far below: values are finite and hardly
 * change. */
static void test_10_at_the_horizon(void **state)
{
    static const char *const commands[] = {"gendaylit -ang 40 0 -P 1 .3",
                                           "gendaylit -ang 40 0 -P 1.1 .3",
                                           "gendaylit -ang 40 0 -P 1.4 .25",
                                           "gendaylit -ang 2 0 -P 1.8 .2",
                                           "gendaylit -ang 60 0 -P 2.5 .15",
                                           "gendaylit -ang 87 0 -P 4 .1",
                                           "gendaylit -ang 10 0 -P 6 .08",
                                           "gendaylit -ang 1 0 -P 12 .05",
                                           "gensky -ang 30 0 +s",
                                           "gensky -ang 1 0 +i",
                                           "gensky -ang 30 0 -c",
                                           "gensky -ang 30 0 -u"};
    const long steps = stability_full() ? 100000 : 1000;
    double jump = 0;
    long odd = 0;
    (void)state;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        char scene[128];
        snprintf(scene, sizeof scene, "!%s\n", commands[i]);
        struct orl_parsed_scene d = scene_parse_text(scene, NULL, NULL);
        assert_int_equal(d.n_skies, 1);
        for (int azimuth = 0; azimuth < 12; azimuth++) {
            double before = -1;
            for (long k = -steps; k <= steps; k++) {
                const double up = 1e-4 * ORL_DEG_TO_RAD * (double)k / (double)steps;
                const double phi = azimuth * ORL_PI / 6, r = cos(up);
                const double value =
                    orl_sky_brightness(&d.skies[0], orl_v3(r * cos(phi), r * sin(phi), sin(up)));
                odd += !isfinite(value) || value < 0;
                if (before > 0)
                    jump = fmax(jump, fabs(value / before - 1));
                before = value;
            }
        }
        orl_parsed_scene_done(&d);
    }
    stability_row(10, "sky at zenith angle 90 deg", "values that are not finite or negative",
                  (double)odd, 0);
    stability_row(10, "sky at zenith angle 90 deg", "|step of L| / L per 1e-7 degrees", jump, 1e-6);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_06_polar),          cmocka_unit_test(test_07_bin_borders),
        cmocka_unit_test(test_08_sun_alone),      cmocka_unit_test(test_09_a_year_with_gaps),
        cmocka_unit_test(test_09_jobs),           cmocka_unit_test(test_09_no_numbers),
        cmocka_unit_test(test_10_at_the_horizon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
