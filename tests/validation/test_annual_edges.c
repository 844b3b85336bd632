/* Edge cases of annual runs: sun discs cut by edges, polar night, the southern hemisphere, leap
 * days, rotated north. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixtures/bsdf_make.h"
#include "scene/generate/sky/sun.h"
#include "support/extent.h"
#include "support/year.h"

#define HEAD(latitude, longitude, zone)                                                            \
    "place p\nlatitude " latitude "\nlongitude " longitude "\ntime_zone " zone                     \
    "\nsite_elevation 0\nweather_data_file_units 1\n"

static const char stone[] = "void plastic w 0 0 5 0 0 0 0 0\nw sphere stone 0 0 4 0 0 -50 .1\n";
static const struct orl_sensor up = {{0, 0, 0}, {0, 0, 1}};

/*
 * Returns the share of a disc of radius 1 on one side of a line at that distance from its middle.
 */
static double left_of_disc(double at)
{
    return 1 - (acos(at) - at * sqrt(1 - at * at)) / ORL_PI;
}

static struct orl_vec3 sun_of(const struct orl_annual_step *step)
{
    const double a = step->sun_altitude_deg * ORL_DEG_TO_RAD;
    const double z = step->sun_azimuth_deg * ORL_DEG_TO_RAD;
    return orl_v3(-cos(a) * sin(z), -cos(a) * cos(z), sin(a));
}

/* A straight edge across the disc, at five positions and four rotations: each result is within 2 %
 * of the whole. */
static void test_half_covered(void **state)
{
    static const double places[] = {-0.7, -0.3, 0, 0.4, 0.8};
    struct year_run run = {.scene = stone,
                           .weather = HEAD("38.42", "-27.14", "-30") "3 22 11.500 800 110\n",
                           .sensors = &up,
                           .n_sensors = 1,
                           .samples = 16};
    struct orl_annual_result open = year_run(&run);
    (void)state;
    assert_int_equal(open.n_columns, 1);
    const struct orl_frame frame = orl_frame_about(sun_of(&open.steps[0]));
    const double whole = (double)open.direct[0], far = 10;
    const double radius = far * tan(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    for (int i = 0; i < 20; i++) {
        const double turn = 0.3 + 0.7 * (i / 5), at = places[i % 5];
        const struct orl_vec3 across = orl_madd(orl_scale(frame.u, cos(turn)), frame.v, sin(turn));
        const struct orl_vec3 along = orl_cross(frame.n, across);
        const struct orl_vec3 edge = orl_madd(orl_scale(frame.n, far), across, at * radius);
        const struct orl_vec3 corners[4] = {orl_madd(edge, along, -1), orl_madd(edge, along, 1),
                                            orl_madd(orl_madd(edge, along, 1), across, 1),
                                            orl_madd(orl_madd(edge, along, -1), across, 1)};
        char scene[1024];
        int used = snprintf(scene, sizeof scene,
                            "void plastic w 0 0 5 0 0 0 0 0\nw polygon screen 0 0 12");
        for (int k = 0; k < 4; k++)
            used += snprintf(scene + used, sizeof scene - (size_t)used, " %.9f %.9f %.9f",
                             corners[k].x, corners[k].y, corners[k].z);
        snprintf(scene + used, sizeof scene - (size_t)used, "\n");
        run.scene = scene;
        struct orl_annual_result year = year_run(&run);
        /* The screen hides what lies beyond the edge. */
        const double seen = (double)year.direct[0] / whole;
        print_message("edge at %+.1f radii: %.4f seen, %.4f left\n", at, seen, left_of_disc(at));
        assert_true(fabs(seen - left_of_disc(at)) < 0.02);
        orl_annual_done(&year);
    }
    orl_annual_done(&open);
}

/* Returns the share of the sun's disc between two lines at those distances from its middle. */
static double strip_of_disc(double low, double high)
{
    return left_of_disc(high) - left_of_disc(low);
}

/*
 * Two screens with a slit between them, away from the disc's middle and rim, at four rotations.
 * With 128 even points one straight edge makes an error of their standard deviation times 128^-3/4;
 * here are two edges, and the bound is three times that.
 */
static void test_slit(void **state)
{
    static const double slits[][2] = {{0.15, 0.3}, {0.4, 0.5}, {-0.6, -0.35}};
    struct year_run run = {.scene = stone,
                           .weather = HEAD("38.42", "-27.14", "-30") "3 22 11.500 800 110\n",
                           .sensors = &up,
                           .n_sensors = 1,
                           .samples = 16};
    struct orl_annual_result open = year_run(&run);
    const double whole = (double)open.direct[0], far = 10;
    const struct orl_frame frame = orl_frame_about(sun_of(&open.steps[0]));
    const double radius = far * tan(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    (void)state;
    for (int i = 0; i < 12; i++) {
        const double turn = 0.2 + 0.6 * (i / 3), *slit = slits[i % 3];
        const struct orl_vec3 across = orl_madd(orl_scale(frame.u, cos(turn)), frame.v, sin(turn));
        const struct orl_vec3 along = orl_cross(frame.n, across);
        char scene[1024];
        int used = snprintf(scene, sizeof scene, "void plastic w 0 0 5 0 0 0 0 0\n");
        for (int k = 0; k < 2; k++) {
            const struct orl_vec3 edge =
                orl_madd(orl_scale(frame.n, far), across, slit[k] * radius);
            const struct orl_vec3 end = orl_madd(edge, across, k == 0 ? -1 : 1);
            const struct orl_vec3 corners[4] = {orl_madd(edge, along, -1), orl_madd(edge, along, 1),
                                                orl_madd(end, along, 1), orl_madd(end, along, -1)};
            used +=
                snprintf(scene + used, sizeof scene - (size_t)used, "w polygon screen%d 0 0 12", k);
            for (int c = 0; c < 4; c++)
                used += snprintf(scene + used, sizeof scene - (size_t)used, " %.9f %.9f %.9f",
                                 corners[c].x, corners[c].y, corners[c].z);
            used += snprintf(scene + used, sizeof scene - (size_t)used, "\n");
        }
        run.scene = scene;
        struct orl_annual_result year = year_run(&run);
        const double seen = (double)year.direct[0] / whole, left = strip_of_disc(slit[0], slit[1]);
        print_message("slit from %+.2f to %+.2f radii: %.4f seen, %.4f left\n", slit[0], slit[1],
                      seen, left);
        assert_true(seen > 0);
        assert_true(fabs(seen - left) < 3 * sqrt(2 * left * (1 - left)) * pow(128, -0.75));
        orl_annual_done(&year);
    }
    orl_annual_done(&open);
}

/* ---- Cells of BSDFs -------------------------------------------------------------------------- */

enum { CELLS = 145, WITHIN_35_DEG = 1 + 8 + 16 + 20 };

/*
 * A pane that scatters light incident at less than 35 degrees from its normal, and blocks the rest.
 */
static struct text make_shy_pane(void)
{
    char *data = calloc(CELLS * CELLS * 8UL, 1);
    size_t used = 0;
    assert_non_null(data);
    for (int out = 0; out < CELLS; out++)
        for (int in = 0; in < CELLS; in++)
            used += (size_t)sprintf(data + used, "%s\n", in < WITHIN_35_DEG ? "0.25" : "0");
    struct text xml = make_file("Columns", "Transmission Front", "LBNL/Klems Full", data);
    free(data);
    return xml;
}

/* Returns the angle between the sun and the southern pane's normal. */
static double off_normal_deg(const struct orl_annual_step *step)
{
    return acos(-sun_of(step).y) / ORL_DEG_TO_RAD;
}

/*
 * While the disc covers two cells of a BSDF, both contribute: minute by minute over the cell edge
 * at 35 degrees, compared with separate jobs. Using only the disc's middle would give all or
 * nothing.
 */
static void test_disc_in_two_cells(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, .6, 1}, {0, -1, .3}}, {{2, 3, .8}, {0, 0, 1}}};
    char weather[2048] = HEAD("38.42", "-27.14", "-30");
    struct text pane = make_shy_pane();
    int parted = 0;
    (void)state;
    for (int minute = 0; minute < 24; minute++)
        snprintf(weather + strlen(weather), sizeof weather - strlen(weather), "12 21 %.5f 850 60\n",
                 13.65 + minute / 60.0);
    const struct year_run run = {.scene = ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE,
                                 .resource_name = "pane.xml",
                                 .resource_text = pane.data,
                                 .site = {38.42, 27.14, 2},
                                 .weather = weather,
                                 .sensors = sensors,
                                 .n_sensors = 2,
                                 .samples = (uint32_t)extent(512, 2048)};
    struct orl_annual_result year = year_run(&run);
    for (size_t c = 0; c < year.n_columns; c++) {
        const struct orl_annual_step *step = &year.steps[year.step_of_column[c]];
        double lx[2], se[2];
        const double off = off_normal_deg(step);
        if (fabs(off - 35) > 0.4)
            continue;
        year_hour(&run, step, (uint32_t)extent(1024, 4096), lx, se);
        for (size_t s = 0; s < 2; s++) {
            const double found = (double)orl_annual_row(&year, year.total, s)[c];
            const double own = (double)orl_annual_row(&year, year.se, s)[c];
            print_message("%.3f degrees: %.0f +- %.0f lx, alone %.0f +- %.0f\n", off, found, own,
                          lx[s], se[s]);
            assert_true(fabs(found - lx[s]) < 4 * hypot(own, se[s]) + 0.01 * lx[s]);
        }
        parted += fabs(off - 35) < 0.2;
    }
    assert_true(parted >= 2);
    orl_annual_done(&year);
    free(pane.data);
}

/* Without light there is no sun node; with light but no sun, direct light is zero and the sky's
 * light remains. */
static void test_polar_night(void **state)
{
    struct year_run run = {.scene = stone,
                           .weather = HEAD("80", "0", "0") "12 21 11.500 0 0\n12 21 12.500 0 0\n",
                           .sensors = &up,
                           .n_sensors = 1,
                           .samples = 256};
    (void)state;
    struct orl_annual_result dark = year_run(&run);
    assert_int_equal(dark.n_steps, 2);
    assert_int_equal(dark.n_columns, 0);
    assert_int_equal(dark.n_nodes, 0);
    assert_int_equal(dark.steps[1].column, ORL_ANNUAL_DARK);
    orl_annual_done(&dark);
    run.weather = HEAD("50", "0", "0") "12 21 11.500 0 100\n12 21 12.500 0 90\n";
    struct orl_annual_result dull = year_run(&run);
    assert_int_equal(dull.n_columns, 2);
    for (int c = 0; c < 2; c++) {
        assert_true(dull.direct[c] == 0);
        assert_true(fabs((double)dull.total[c] / dull.steps[c].global_lx - 1) < 0.02);
    }
    orl_annual_done(&dull);
}

/* At noon in December the sun is in the north at 35 degrees south, and in the south at 35 degrees
 * north. */
static void test_south(void **state)
{
    static const struct orl_sensor sides[] = {{{0, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {0, -1, 0}}};
    static const char *const weathers[] = {HEAD("-35", "0", "0") "12 21 11.500 800 100\n",
                                           HEAD("35", "0", "0") "12 21 11.500 800 100\n"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct year_run run = {.scene = stone,
                                     .weather = weathers[i],
                                     .sensors = sides,
                                     .n_sensors = 2,
                                     .samples = 16};
        struct orl_annual_result year = year_run(&run);
        assert_int_equal(year.n_columns, 1);
        assert_true(year.direct[i] > 1000);
        assert_true(year.direct[1 - i] == 0);
        orl_annual_done(&year);
    }
}

/* A leap day in the file is computed like other days; time stamps are the file's. */
static void test_leap_day(void **state)
{
    const struct year_run run = {
        .scene = stone,
        .weather = HEAD("38", "0", "0") "2 28 11.500 500 100\n2 29 11.500 500 100\n"
                                        "3 1 11.500 500 100\n",
        .sensors = &up,
        .n_sensors = 1,
        .samples = 16};
    (void)state;
    struct orl_annual_result year = year_run(&run);
    assert_int_equal(year.n_columns, 3);
    assert_int_equal(year.steps[1].month, 2);
    assert_int_equal(year.steps[1].day, 29);
    assert_true(year.steps[1].hour == 11.5);
    /* The sun is higher each day. */
    assert_true(year.steps[0].sun_altitude_deg <= year.steps[1].sun_altitude_deg);
    assert_true(year.steps[1].sun_altitude_deg <= year.steps[2].sun_altitude_deg);
    orl_annual_done(&year);
}

/*
 * With true north along -x, south is +x: a sensor that faces there gets the southern sensor's sun.
 */
static void test_north(void **state)
{
    static const struct orl_sensor south = {{0, 0, 0}, {0, -1, 0}}, east = {{0, 0, 0}, {1, 0, 0}};
    struct year_run run = {.scene = stone,
                           .weather = HEAD("38.42", "-27.14", "-30") "3 22 9.500 600 110\n"
                                                                     "3 22 15.500 500 140\n",
                           .sensors = &south,
                           .n_sensors = 1,
                           .samples = 4096};
    (void)state;
    struct orl_annual_result straight = year_run(&run);
    run.sensors = &east;
    run.north_deg = 90;
    struct orl_annual_result turned = year_run(&run);
    for (int c = 0; c < 2; c++) {
        const double se = hypot((double)straight.se[c], (double)turned.se[c]);
        assert_true(fabs((double)(straight.direct[c] - turned.direct[c])) <
                    1e-4 * (double)straight.direct[c]);
        assert_true(fabs((double)(straight.total[c] - turned.total[c])) <
                    4 * se + 1e-4 * (double)straight.total[c]);
    }
    orl_annual_done(&straight);
    orl_annual_done(&turned);
}

/* Writes an EPW of twenty days of clear hours, with global irradiance for a sun that is later_h
 * later than in the middle of the rows' hours. */
static void write_clear_days(double later_h, char *text, size_t size)
{
    const struct orl_location site = {38 * ORL_DEG_TO_RAD, 0, 0};
    size_t n = (size_t)snprintf(
        text, size, "LOCATION,a,b,c,d,e,38,0,0,25\nDATA PERIODS,1,1,Data,Sunday,6/1,6/20\n");
    for (int day = 1; day <= 20; day++)
        for (int hour = 8; hour <= 17; hour++) {
            const struct orl_moment at = {2021, 6, day, hour - 0.5 + later_h, false};
            const double sine = sin(orl_sun_accurate(&site, &at).altitude_rad);
            n += (size_t)snprintf(text + n, size - n,
                                  "2021,6,%d,%d,0,f,0,0,0,0,0,0,0,%.2f,700,100\n", day, hour,
                                  100 + 700 * sine);
            assert_true(n < size);
        }
}

static bool says_shift(char *const *warnings, size_t n)
{
    bool says = false;
    for (size_t i = 0; i < n; i++)
        says = says || strstr(warnings[i], "30 minutes too late");
    return says;
}

/* Annual runs and single skies warn if the file's times are half an hour late. */
static void test_shifted_file(void **state)
{
    static const double later_h[] = {0, -0.5};
    static const struct orl_annual_step noon = {.month = 6, .day = 10, .hour = 11.5};
    static char text[200 * 80];
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct year_run run = {
            .scene = stone, .weather = text, .sensors = &up, .n_sensors = 1, .samples = 16};
        write_clear_days(later_h[i], text, sizeof text);
        struct orl_annual_result year = year_run(&run);
        struct orl_result hour = year_hour_result(&run, &noon, 16);
        assert_int_equal(says_shift(year.warnings, year.n_warnings), i == 1);
        assert_int_equal(says_shift(hour.warnings, hour.n_warnings), i == 1);
        orl_annual_done(&year);
        orl_result_done(&hour);
    }
}

/* Light mirrored by a glass ball is left out, and one warning names the ball's file and line. */
static void test_curved_glass(void **state)
{
    const struct year_run run = {.scene =
                                     "void plastic w 0 0 5 0 0 0 0 0\n"
                                     "w sphere stone 0 0 4 0 0 -50 .1\n"
                                     "void glass g 0 0 3 .9 .9 .9\ng sphere ball 0 0 4 9 9 0 1\n",
                                 .weather = HEAD("38", "0", "0") "6 21 11.500 800 100\n",
                                 .sensors = &up,
                                 .n_sensors = 1,
                                 .samples = 16};
    struct orl_annual_result year = year_run(&run);
    size_t told = 0;
    (void)state;
    for (size_t i = 0; i < year.n_warnings; i++)
        told += strstr(year.warnings[i], "1 curved panes") &&
                strstr(year.warnings[i], "ball at scene.rad:4");
    assert_int_equal(told, 1);
    orl_annual_done(&year);
}

/* Where the sun does not set for weeks, hours equal those of separate jobs. */
static void test_midnight_sun(void **state)
{
    static const char room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}}, {{1, 4, .8}, {0, 0, 1}}};
    char weather[1 << 12] = HEAD("70", "0", "0");
    const struct year_site site = {70, 0, 0};
    (void)state;
    for (int month = 3; month <= 6; month++)
        year_day(&site, month, 21, weather, sizeof weather);
    struct year_run run = {.scene = room, .weather = weather, .sensors = sensors, .n_sensors = 2};
    struct orl_annual_result year = year_run(&run);
    double squares = 0;
    size_t n = 0;
    assert_true(year.n_columns > 60);
    for (size_t c = 1; c < year.n_columns; c += 6) {
        double lx[2], se[2];
        year_hour(&run, &year.steps[year.step_of_column[c]], 1024, lx, se);
        for (size_t s = 0; s < 2; s++, n++) {
            const double off = (double)orl_annual_row(&year, year.total, s)[c] - lx[s];
            const double own = (double)orl_annual_row(&year, year.se, s)[c];
            const double z = off / hypot(hypot(own, se[s]), 2e-3 * lx[s] + 1e-9);
            squares += z * z;
            assert_true(fabs(z) < 4.5); /* Student's t with 15 degrees of freedom: once in 2000 */
        }
    }
    print_message("%zu sensor-hours: z rms %.2f\n", n, sqrt(squares / (double)n));
    assert_true(squares < 1.5 * 1.5 * (double)n);
    orl_annual_done(&year);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shifted_file), cmocka_unit_test(test_half_covered),
        cmocka_unit_test(test_slit),         cmocka_unit_test(test_polar_night),
        cmocka_unit_test(test_south),        cmocka_unit_test(test_leap_day),
        cmocka_unit_test(test_north),        cmocka_unit_test(test_curved_glass),
        cmocka_unit_test(test_midnight_sun), cmocka_unit_test(test_disc_in_two_cells),
    };
    return cmocka_run_group_tests_name("annual_edges", tests, NULL, NULL);
}
