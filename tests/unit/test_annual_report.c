/*
 * The report of a hand-made year: rows of weather files as steps, grids, verdicts; the report's
 * files, read back byte by byte, and by NumPy if it is installed.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/io/out_file.h"
#include <oriel/annual/annual_report.h>
#include <oriel/base/thread_pool.h>

#include "metrics/annual/annual_figures.h"
#include "support/hand_year.h"
#include "support/scene_text.h"
#include "support/scratch.h"

static char *read_file(const char *name, size_t *ret_size)
{
    return (char *)scene_read_bytes(scratch_path(name), ret_size);
}

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

/* ---- Years ----------------------------------------------------------------------------------- */

static void test_years(void **state)
{
    struct orl_annual_result result;
    struct orl_annual_timeline year;
    struct orl_error err = {0};
    (void)state;
    hand_year_make(&result, true);
    assert_int_equal(orl_annual_timeline_make(&result, &year, &err), 0);
    assert_int_equal(year.steps.count, 8784);
    assert_int_equal(year.n_missing, 0);
    assert_int_equal(year.step_of_column[HAND_YEAR_LIT], 24 + HAND_YEAR_FIRST_LIT);
    assert_int_equal(year.step_of_column[result.n_columns - 1], 8783 - 6);
    orl_annual_timeline_done(&year);
    /* Hours that were not measured, and a file that ends early. */
    result.steps[8].missing = true;
    result.steps[5].missing = true;          /* at night: certainly dark */
    result.steps[29].sun_altitude_deg = 3.5; /* dark with the sun up: implausible */
    result.steps[12].sun_altitude_deg = 40;
    result.n_steps -= 24;
    assert_int_equal(orl_annual_timeline_make(&result, &year, &err), 0);
    assert_int_equal(year.n_missing, 25);
    assert_int_equal(year.n_doubtful, 1);
    assert_true(year.measured[5] && !year.measured[8] && !year.measured[8783]);
    orl_annual_timeline_done(&year);
    result.steps[100].hour = result.steps[99].hour;
    assert_int_equal(orl_annual_timeline_make(&result, &year, &err), ORL_ERR_RANGE);
    hand_year_free(&result);
    hand_year_make(&result, false);
    assert_int_equal(orl_annual_timeline_make(&result, &year, &err), 0);
    assert_int_equal(year.steps.count, 8760);
    assert_int_equal(orl_annual_step_of(&year, &result.steps[8759]), 8759);
    orl_annual_timeline_done(&year);
    hand_year_free(&result);
}

/* Printed times of rows are the beginnings of steps, as in Honeybee, their ends or their middles,
 * in 1/6 h. */
static void test_times_of_steps(void **state)
{
    static const double firsts[] = {0, 1, 0.5};
    enum { DAY = 24 * 6 };
    static struct orl_annual_step steps[3 * DAY];
    (void)state;
    for (int k = 0; k < 3; k++) {
        const struct orl_annual_result result = {.steps = steps,
                                                 .n_steps = sizeof steps / sizeof *steps};
        struct orl_annual_timeline year;
        struct orl_error err = {0};
        for (size_t i = 0; i < result.n_steps; i++)
            steps[i] = (struct orl_annual_step){
                .month = 6,
                .day = 1 + (int)(i / DAY),
                .hour = round(1000 * ((double)(i % DAY) + firsts[k]) / 6) / 1000,
                .column = ORL_ANNUAL_DARK};
        if (orl_annual_timeline_make(&result, &year, &err) < 0)
            fail_msg("first time %g / 6 h: %s", firsts[k], err.message);
        assert_int_equal(year.steps.per_hour, 6);
        for (uint32_t i = 0; i < result.n_steps; i++)
            assert_int_equal(orl_annual_step_of(&year, &steps[i]), 151 * DAY + i);
        orl_annual_timeline_done(&year);
    }
}

/* Threads share the sensors: the report is the same to the last bit for any number of threads. */
static void test_threads(void **state)
{
    struct orl_annual_grid grids[2];
    struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report alone, together;
    struct orl_thread_pool *pool = orl_thread_pool_start(3);
    struct orl_error err = {0};
    (void)state;
    assert_non_null(pool);
    hand_year_make(&result, false);
    hand_year_ask(&report_request, "sDA300/50 >= 55 %", "LEED");
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &alone, &err),
        0);
    assert_int_equal(orl_annual_report_make(&request, &result, &report_request, NULL, NULL, pool,
                                            &together, &err),
                     0);
    assert_int_equal(alone.n_unlit, together.n_unlit);
    assert_true(alone.n_metrics > 0 && alone.n_verdicts > 0);
    assert_memory_equal(alone.values, together.values,
                        alone.n_metrics * alone.n_sensors * sizeof *alone.values);
    for (size_t i = 0; i < alone.n_verdicts; i++)
        assert_memory_equal(&alone.verdicts[i].area, &together.verdicts[i].area,
                            sizeof alone.verdicts[i].area);
    orl_annual_report_done(&alone);
    orl_annual_report_done(&together);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
    orl_thread_pool_stop(pool);
}

/* A file without rows at night gives a whole year. Beyond the polar circles, days without a
 * sunrise have no rows at all. */
static void test_nights_left_out(void **state)
{
    static const double latitudes[] = {0, 70};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct orl_annual_result result;
        struct orl_annual_timeline year;
        struct orl_error err = {0};
        size_t kept = 0;
        hand_year_make(&result, false);
        result.site.latitude_deg = latitudes[k];
        for (size_t i = 0; i < result.n_steps; i++) {
            const struct orl_annual_step step = result.steps[i];
            const bool polar_night = k == 1 && (step.month == 12 || step.month == 1);
            if (step.column != ORL_ANNUAL_DARK && !(polar_night && step.day > 12 && step.day < 20))
                result.steps[kept++] = step;
        }
        result.n_steps = kept;
        assert_int_equal(orl_annual_timeline_make(&result, &year, &err), 0);
        if (k == 0)
            assert_int_equal(year.n_missing, 0);
        for (size_t i = 0; i < 24; i++) /* 15 December */
            assert_true(year.measured[348 * 24 + i]);
        orl_annual_timeline_done(&year);
        hand_year_free(&result);
    }
}

/* ---- Reports --------------------------------------------------------------------------------- */

/* Sensors 0 to 5 have 100 to 600 lx in all occupied hours: four meet 300 lx, the third exactly. */
static struct orl_window_group blinds = {
    .control = {.kind = ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2}};

static void test_reports(void **state)
{
    struct orl_annual_grid grids[2];
    struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_error err = {0};
    (void)state;
    hand_year_make(&result, false);
    request.groups = &blinds;
    request.n_groups = 1;
    hand_year_ask(&report_request, "sDA300/50 of SOUTH >= 55 %", "LEED");
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        0);
    assert_near(report.periods[ORL_WHEN_OCCUPIED].hours, 3650, 0);
    assert_near(report.values[2].value, 100, 0); /* DA300 of the third sensor */
    assert_near(report.values[2].low, 0, 0);     /* two per cent less light gives 0 */
    assert_near(report.areas[0].value.value, 0, 0);
    assert_near(report.areas[1].value.value, 100, 0);
    assert_near(report.areas[1].value.low, 75, 0);
    assert_int_equal(report.areas[1].open, 1);
    assert_near(report.areas[2].value.value, 100 * 4 / 6.0, 1e-9);
    assert_near(report.areas[3 + 1].value.value, 50, 1e-9); /* ASE: 365 hours at two of four */
    assert_int_equal(report.n_verdicts, 1 + 4 * 3);
    assert_int_equal(report.verdicts[0].grid, 1);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_PASS);
    /* 66.7 % of both together, or 50 if the third is too dark: over 40, perhaps over 55, not over
     * 75. */
    assert_int_equal(report.verdicts[1].grid, ORL_ALL_GRIDS);
    assert_int_equal(report.verdicts[1].verdict, ORL_VERDICT_PASS);
    assert_int_equal(report.verdicts[4].verdict, ORL_VERDICT_UNDECIDED);
    assert_int_equal(report.verdicts[7].verdict, ORL_VERDICT_FAIL);
    orl_annual_report_done(&report);
    snprintf(report_request.targets[0].grid, sizeof report_request.targets[0].grid, "east");
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        ORL_ERR_INVALID);
    report_request.targets[0].grid[0] = '\0';
    report_request.occupancy.days = 0;
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        ORL_ERR_INVALID);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* Sensors have daylight factors of 1 to 6 %; 300 lx are 2 % of the given median, and 100 lx two
 * thirds of one. By the weather, the hours of half the year's steps count: all lit ones, with 10
 * 000 lx. */
static void test_daylight_factor(void **state)
{
    const struct orl_annual_request request = {.n_sensors = HAND_YEAR_SENSORS};
    float overcast[HAND_YEAR_SENSORS], se[HAND_YEAR_SENSORS] = {0};
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_error err = {0};
    (void)state;
    hand_year_make(&result, false);
    for (int i = 0; i < HAND_YEAR_SENSORS; i++)
        overcast[i] = 100.0F * (float)(i + 1);
    for (size_t i = 0; i < result.n_steps; i++)
        result.steps[i].diffuse_lx = result.steps[i].global_lx > 0 ? 10000 + (double)(i % 2) : 0;
    result.overcast = overcast;
    result.overcast_se = se;
    hand_year_ask(&report_request, "least DF >= 1 %", "daylight factor by EN 17037 minimum");
    report_request.median_diffuse_lx = 15000;
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        0);
    assert_int_equal(report.n_verdicts, 3);
    assert_near(report.verdicts[0].area.value.value, 1, 1e-6);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_PASS);
    assert_near(report.verdicts[1].target.figure.least, 2, 1e-9);
    assert_near(report.verdicts[1].area.value.value, 100 * 5 / 6.0, 1e-9);
    assert_int_equal(report.verdicts[1].verdict, ORL_VERDICT_PASS);
    assert_near(report.verdicts[2].area.value.value, 100, 1e-9);
    orl_annual_report_done(&report);
    report_request.median_diffuse_lx = 0;
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        0);
    assert_near(report.median_diffuse_lx, 10000.5, 1e-9);
    assert_near(report.verdicts[1].target.figure.least, 100 * 300 / 10000.5, 1e-9);
    orl_annual_report_done(&report);
    /* Half a year has no annual median; a daylight factor alone does not depend on the weather. */
    for (size_t i = 181 * 24; i < result.n_steps; i++)
        result.steps[i].missing = true;
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, &err),
        0);
    assert_near(report.median_diffuse_lx, 10000.5, 1e-9);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_PASS);
    assert_int_equal(report.verdicts[1].verdict, ORL_VERDICT_UNDECIDED);
    assert_string_equal(report.verdicts[1].note,
                        "the weather file has 2172 of 4380 daylight hours");
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* A year of 365 days that begins on a Sunday has 260 days from Monday to Friday. One that begins
 * on a Monday, the default, has 261. The weather file determines the weekday, unless the occupancy
 * does. If the file begins on 1 July, its second half is of the next year: 31 December is a
 * Saturday here, the day before Sunday, 1 January. */
static void test_weekdays(void **state)
{
    static const struct {
        int by_weather;
        unsigned asked;
        double hours;
        size_t n_moved;
    } cases[] = {{6, ORL_FIRST_DAY_OF_WEATHER, 2600, 0},
                 {-1, ORL_FIRST_DAY_OF_WEATHER, 2610, 0},
                 {6, 0, 2610, 0},
                 {0, 6, 2600, 0},
                 {6, ORL_FIRST_DAY_OF_WEATHER, 2610, 181 * 24}};
    const struct orl_annual_request request = {.n_sensors = HAND_YEAR_SENSORS};
    struct orl_annual_result result;
    (void)state;
    hand_year_make(&result, false);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_report_request report_request;
        struct orl_annual_report report;
        hand_year_ask(&report_request, "sDA300/50 >= 55 %", "LEED");
        assert_int_equal(report_request.occupancy.first_day, ORL_FIRST_DAY_OF_WEATHER);
        report_request.occupancy.days = 0x1f;
        report_request.occupancy.first_day = cases[i].asked;
        result.first_weekday = cases[i].by_weather;
        result.n_moved = cases[i].n_moved;
        assert_int_equal(orl_annual_report_make(&request, &result, &report_request, NULL, NULL,
                                                NULL, &report, NULL),
                         0);
        assert_near(report.periods[ORL_WHEN_OCCUPIED].hours, cases[i].hours, 1e-9);
        orl_annual_report_done(&report);
        orl_report_request_done(&report_request);
    }
    hand_year_free(&result);
}

/* 52 560 rows of 10 minutes are a year; a row every 5 minutes is refused. */
static void test_short_steps(void **state)
{
    static const struct {
        uint32_t per_hour;
        int code;
    } cases[] = {{6, 0}, {12, ORL_ERR_LIMIT}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const uint32_t per_hour = cases[i].per_hour;
        char *text = NULL;
        size_t size, rows = 0;
        FILE *stream = open_memstream(&text, &size);
        struct orl_annual_steps steps = {0};
        struct orl_error err = {0};
        assert_non_null(stream);
        fputs("place a\nlatitude 38\nlongitude -27\ntime_zone -30\nsite_elevation 25\n"
              "weather_data_file_units 1\n",
              stream);
        for (uint32_t k = 0; k < 8760 * per_hour; k++) {
            const struct orl_annual_steps all = {8760 * per_hour, per_hour};
            const struct orl_calendar_day day = orl_calendar_day_of(&all, k);
            fprintf(stream, "%d %d %.3f 0 1\n", day.month, day.day, orl_calendar_hour_of(&all, k));
        }
        assert_int_equal(fclose(stream), 0);
        assert_int_equal(orl_annual_weather_check("a.wea", text, size, 0, &steps, &rows, &err),
                         cases[i].code);
        if (cases[i].code == 0) {
            assert_int_equal(rows, 52560);
            assert_true(steps.count == 52560 && steps.per_hour == 6);
        } else {
            assert_non_null(strstr(err.message, "105120 rows, but a year has at most 52704"));
        }
        free(text);
    }
}

/* Grids of areas 1 and 3: half of the sensors of the second have most of the weight. */
static void test_areas_and_files_of_occupancy(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    static char text[8760 * 2];
    const struct orl_file file = {text, sizeof text, NULL};
    static const char *const names[] = {"use.csv"};
    struct orl_memory_files memory = {names, &file, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 8760; i++)
        memcpy(text + 2 * (size_t)i, i % 24 == 12 ? "1\n" : "0\n", 2);
    hand_year_make(&result, false);
    hand_year_ask(&report_request, "ASE <= 10 %", "LEED");
    report_request.occupancy_file = strdup("use.csv");
    report_request.grid_area = calloc(2, sizeof *report_request.grid_area);
    assert_true(report_request.occupancy_file && report_request.grid_area);
    report_request.grid_area[0] = 1;
    report_request.grid_area[1] = 3;
    assert_int_equal(orl_annual_report_make(&request, &result, &report_request, &files, NULL, NULL,
                                            &report, &err),
                     0);
    assert_near(report.periods[ORL_WHEN_OCCUPIED].hours, 365, 0);
    assert_near(report.areas[3 + 2].value.value, 37.5, 1e-9); /* half of 3 of 4 */
    assert_near(report.areas[2].value.value, 75, 1e-9);
    orl_annual_report_done(&report);
    text[1] = 'x';
    assert_int_equal(orl_annual_report_make(&request, &result, &report_request, &files, NULL, NULL,
                                            &report, &err),
                     ORL_ERR_SYNTAX);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static void test_arrays(void **state)
{
    const float values[6] = {0, 1.5F, -2, 3e5F, 1e-3F, 7};
    size_t size;
    (void)state;
    assert_int_equal(orl_npy_write(scratch_path("a.npy"), values, 2, 3, NULL, NULL), 0);
    char *bytes = read_file("a.npy", &size);
    const size_t header = 10 + (unsigned char)bytes[8] + 256 * (size_t)(unsigned char)bytes[9];
    assert_memory_equal(bytes, "\x93NUMPY\x01", 8);
    assert_int_equal(header % 64, 0);
    assert_int_equal(bytes[header - 1], '\n');
    bytes[header - 1] = '\0';
    assert_non_null(strstr(bytes + 10, "'descr': '<f4'"));
    assert_non_null(strstr(bytes + 10, "'fortran_order': False"));
    assert_non_null(strstr(bytes + 10, "'shape': (2, 3)"));
    assert_int_equal(size, header + sizeof values);
    assert_memory_equal(bytes + header, values, sizeof values);
    free(bytes);
    assert_int_equal(orl_matrix_write(scratch_path("a.ill"), values, 2, 3, true, NULL, NULL), 0);
    bytes = read_file("a.ill", &size);
    assert_string_equal(bytes, "#?RADIANCE\nNROWS=2\nNCOLS=3\nNCOMP=1\nFORMAT=ascii\n\n"
                               "0\t1.5\t-2\n300000\t0.001\t7\n");
    free(bytes);
    assert_int_equal(orl_matrix_write(scratch_path("a.mtx"), values, 2, 3, false, NULL, NULL), 0);
    bytes = read_file("a.mtx", &size);
    assert_non_null(strstr(bytes, "FORMAT=float\n\n"));
    assert_memory_equal(bytes + size - sizeof values, values, sizeof values);
    free(bytes);
    assert_int_equal(orl_coefficients_write(scratch_path("a.dc.mtx"), values, 2, 3, NULL, NULL), 0);
    bytes = read_file("a.dc.mtx", &size);
    assert_non_null(strstr(bytes, "NROWS=2\nNCOLS=3\nNCOMP=3\n"));
    for (int i = 0; i < 3; i++)
        assert_memory_equal(bytes + size - 12 + 4 * i, &values[5], sizeof *values);
    free(bytes);
    assert_int_equal(orl_npy_write(scratch_path("none/a.npy"), values, 2, 3, NULL, NULL),
                     ORL_ERR_IO);
}

static size_t count_lines(const char *text)
{
    size_t lines = 0;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

static void assert_holds(const char *name, const char *part)
{
    size_t size;
    char *text = read_file(name, &size);
    if (!strstr(text, part))
        fail_msg("%s does not hold '%s': %.300s", name, part, text);
    free(text);
}

/* Compares with the numbers that NumPy reads; does nothing if NumPy is not installed. */
static void ask_numpy(void)
{
    char command[1024];
    snprintf(command, sizeof command,
             "python3 -c \"\nimport sys\ntry:\n    import numpy\nexcept ImportError:\n    "
             "sys.exit(0)\na = "
             "numpy.load('%s/hb/__static_apertures__/default/total/south.npy')\nassert a.shape == "
             "(4, 4380) and a.dtype == numpy.float32, a.shape\nassert a[0, 0] == 300 and a[3, 6] "
             "== 5600\nb = numpy.loadtxt('%s/hb/metrics/da/south.da')\nassert (b == 100).all()\n\"",
             scratch_path(""), scratch_path(""));
    assert_int_equal(system(command), 0);
}

/* Checks that the array of errors has the header and the size of the array of values. */
static void assert_errors_lie_beside(const struct orl_annual_result *result)
{
    static const char *const names[] = {"hb/__static_apertures__/default/total/south.npy",
                                        "hb/__static_apertures__/default/se/south.npy"};
    const size_t values = 4 * result->n_columns;
    const float *const wanted[] = {orl_annual_row(result, result->total, 2),
                                   orl_annual_row(result, result->se, 2)};
    for (int i = 0; i < 2; i++) {
        size_t size;
        char *const bytes = read_file(names[i], &size);
        assert_int_equal(size, 128 + values * sizeof(float));
        assert_memory_equal(bytes + 128, wanted[i], values * sizeof(float));
        free(bytes);
    }
}

static void test_honeybees_folder(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    size_t size;
    (void)state;
    hand_year_make(&result, false);
    hand_year_ask(&report_request, "ASE <= 10 %", "LEED");
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, NULL),
        0);
    for (int again = 0; again < 2; again++)
        assert_int_equal(
            orl_honeybee_write(scratch_path("hb"), &report, &result, NULL, NULL, NULL, NULL), 0);
    assert_holds("hb/grids_info.json", "{\"count\": 2, \"name\": \"North / \\\"old\\\"\", "
                                       "\"identifier\": \"North____old_\"");
    assert_holds("hb/grid_states.json", "\"south\": {\"__static_apertures__\": [\"default\"]}");
    assert_holds("hb/study_info.json", "{\"timestep\": 1, \"study_hours\": [0.5, 1.5, ");
    assert_holds("hb/sun-up-hours.txt", "6.5\n7.5\n8.5\n");
    assert_holds("hb/metrics/ase/south.ase", "50.00");
    assert_holds("hb/metrics/hours_above/south.res", "0\n0\n365\n365\n");
    assert_holds("hb/metrics/udi_upper/south.udi", "0.00\n0.00\n10.00\n10.00\n");
    assert_holds("hb/metrics/cda/North____old_.cda", "33.33\n66.67\n");
    assert_holds("hb/metrics/summary.json", "\"Sensor Count\": 4, \"sDA\": 100.00, \"ASE\": 50.00");
    char *hours = read_file("hb/sun-up-hours.txt", &size);
    assert_int_equal(count_lines(hours), 4380);
    free(hours);
    assert_errors_lie_beside(&result);
    ask_numpy();
    float *const se = result.se;
    result.se = NULL; /* results of matrices have no errors */
    assert_int_equal(
        orl_honeybee_write(scratch_path("bare"), &report, &result, NULL, NULL, NULL, NULL), 0);
    assert_int_equal(access(scratch_path("bare/__static_apertures__/default/total"), F_OK), 0);
    assert_int_equal(access(scratch_path("bare/__static_apertures__/default/se"), F_OK), -1);
    result.se = se;
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

static void test_tables(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_sensor sensors[HAND_YEAR_SENSORS] = {{{1, 2, 0.75}, {0, 0, 1}}};
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    size_t size;
    (void)state;
    hand_year_make(&result, false);
    result.steps[12].missing = true;
    hand_year_ask(&report_request, "ASE <= 10 %", "LEED");
    assert_int_equal(
        orl_annual_report_make(&request, &result, &report_request, NULL, NULL, NULL, &report, NULL),
        0);
    assert_int_equal(orl_annual_sensors_csv(scratch_path("s.csv"), &report, sensors, NULL, NULL),
                     0);
    assert_int_equal(
        orl_annual_hours_csv(scratch_path("h.csv"), &request, &report, &result, NULL, NULL), 0);
    assert_holds("s.csv", "grid,x,y,z,dx,dy,dz,\"DA300 (%)\",low_95,high_95,");
    assert_holds("s.csv", "\n\"North / \"\"old\"\"\",1,2,0.75,0,0,1,0,0,0,");
    char *text = read_file("s.csv", &size);
    assert_int_equal(count_lines(text), 1 + HAND_YEAR_SENSORS);
    free(text);
    assert_holds("h.csv", ",\"North / \"\"old\"\"\",\"south\",\"standard error of North / "
                          "\"\"old\"\"\",\"standard error of south\"\n1,1,0.5,0,");
    /* hypot(2, 4) / 2, and the root of 6^2 + 8^2 + 10^2 + 12^2, by 4. */
    assert_holds("h.csv", "\n1,1,8.5,1,0.0000,0,0,10008,150,450,2.23607,4.63681\n");
    assert_holds("h.csv", "\n1,1,12.5,0,0.0000,,,,,,,\n"); /* not measured: no values */
    text = read_file("h.csv", &size);
    assert_int_equal(count_lines(text), 8761);
    free(text);
    float *const se = result.se;
    result.se = NULL; /* results of matrices have no errors */
    assert_int_equal(
        orl_annual_hours_csv(scratch_path("h.csv"), &request, &report, &result, NULL, NULL), 0);
    assert_holds("h.csv", ",\"south\"\n1,1,0.5,0,");
    assert_holds("h.csv", "\n1,1,8.5,1,0.0000,0,0,10008,150,450\n");
    result.se = se;
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* ---- Errors of hours ------------------------------------------------------------------------- */

enum { NOON = 6 }; /* the column of 12:30 on the first day, of HAND_YEAR_LIT */

static void put_hour(struct orl_annual_result *result, size_t sensor, size_t day, float lx,
                     float se)
{
    const size_t column = day * HAND_YEAR_LIT + NOON, at = sensor * result->n_columns + column;
    result->total[at] = lx;
    result->se[at] = se;
}

/* Returns the only warning about errors, or NULL if there is none. The caller frees it; the
 * result's warnings are freed here. */
static char *warn_of_hours(const struct orl_annual_request *request,
                           struct orl_annual_result *result)
{
    struct orl_report_request report_request;
    struct orl_annual_report report;
    char *said = NULL;
    assert_int_equal(orl_report_request_init(&report_request), 0);
    report = hand_year_report(request, result, &report_request);
    assert_int_equal(orl_annual_report_warn(request, &report, result, NULL, NULL, NULL), 0);
    for (size_t i = 0; i < result->n_warnings; i++) {
        if (strstr(result->warnings[i], "standard error"))
            said = strdup(result->warnings[i]);
        free(result->warnings[i]);
    }
    free(result->warnings);
    result->warnings = NULL;
    result->n_warnings = 0;
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    return said;
}

static void assert_warns(const struct orl_annual_request *request, struct orl_annual_result *result,
                         const char *wanted)
{
    char *const said = warn_of_hours(request, result);
    if (!said || !strstr(said, wanted))
        fail_msg("'%s' is not in: %s", wanted, said ? said : "(no warning)");
    free(said);
}

static void assert_warns_not(const struct orl_annual_request *request,
                             struct orl_annual_result *result)
{
    char *const said = warn_of_hours(request, result);
    if (said)
        fail_msg("%s", said);
}

/* Hours count if their error is above 25 % of the light and they may have 100 lx. */
static void test_hours_that_count(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    (void)state;
    hand_year_make(&result, false);
    assert_warns_not(&request, &result); /* 2 % each */
    put_hour(&result, 0, 0, 400, 100);   /* not above */
    put_hour(&result, 1, 0, 5, 47);      /* 99 lx */
    assert_warns_not(&request, &result);
    put_hour(&result, 3, 20, 400, 101);
    assert_warns(&request, &result,
                 "the standard error is above 25 % of the illuminance in 1 of 4380 lit hours, at 1 "
                 "of 6 sensors (counted where illuminance and twice the error are 100 lx or more; "
                 "the worst is sensor 2 (from 1) of 'south' on 21 January at 12:30, 400 lx with an "
                 "error of 101 lx): more \"samples\" reduce it");
    put_hour(&result, 1, 30, 40, 30); /* may be 100 lx */
    put_hour(&result, 2, 30, 400, 150);
    put_hour(&result, 2, 31, 400, 150);
    assert_warns(&request, &result, "in 3 of 4380 lit hours, at 3 of 6 sensors");
    assert_warns(
        &request, &result,
        "sensor 2 (from 1) of 'North / \"old\"' on 31 January at 12:30, 40 lx with an error "
        "of 30 lx)");
    float *const se = result.se;
    result.se = NULL;
    assert_warns_not(&request, &result);
    result.se = se;
    hand_year_free(&result);
}

/* More samples alone do not help where the sun is interpolated, and the warning says so. */
static void test_remedies(void **state)
{
    struct orl_annual_grid grids[2];
    struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    (void)state;
    hand_year_make(&result, false);
    put_hour(&result, 3, 20, 400, 200);
    put_hour(&result, 3, 21, 400, 200);
    result.steps[result.step_of_column[21 * HAND_YEAR_LIT + NOON]].direct_normal_lx = 5e4;
    assert_warns(
        &request, &result,
        ": more \"samples\" reduce the error of paths; in hours with sun (1), interpolation "
        "between sun positions adds an error that \"sun_halvings\": 1 reduces");
    request.sun_halvings = 1;
    assert_warns(&request, &result, "that \"sun_halvings\": 2 reduces");
    request.sun_halvings = ORL_ANNUAL_MOST_HALVINGS;
    assert_warns(&request, &result, "adds an error, with \"sun_halvings\" at its maximum");
    hand_year_free(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_years),
        cmocka_unit_test(test_times_of_steps),
        cmocka_unit_test(test_reports),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_nights_left_out),
        cmocka_unit_test(test_daylight_factor),
        cmocka_unit_test(test_weekdays),
        cmocka_unit_test(test_short_steps),
        cmocka_unit_test(test_areas_and_files_of_occupancy),
        cmocka_unit_test_setup_teardown(test_arrays, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_honeybees_folder, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_tables, scratch_set_up, scratch_tear_down),
        cmocka_unit_test(test_hours_that_count),
        cmocka_unit_test(test_remedies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
