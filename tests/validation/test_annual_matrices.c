/* Annual runs by matrices of other programs, compared with products computed by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/vec.h>

#include "support/year.h"

enum { SENSORS = 3, IN = 2, OUT = 2, PATCHES = 4, FILES = 8, SIZE = 1 << 16 };

static const struct year_site izmir = {38.42, 27.14, 2};
static char scene_name[] = "scene.rad", weather_name[] = "w.wea", view[] = "v.mtx",
            grid[] = "desks", transmission[] = "t.mtx", daylight[] = "d.mtx", sky[] = "s.smx",
            other[] = "x.mtx";
static char *scene_names[] = {scene_name};

/* Value of a test matrix in channel k. */
static double value_of(int matrix, size_t row, size_t column, int k)
{
    return 0.1 * (double)((matrix * 7 + (int)row * 5 + (int)column * 3 + k * 2) % 11);
}

static void write_matrix(int matrix, size_t rows, size_t columns, char *text)
{
    int n = snprintf(text, SIZE, "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=3\nFORMAT=ascii\n\n",
                     rows, columns);
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            for (int k = 0; k < 3; k++)
                n += snprintf(text + n, (size_t)(SIZE - n), "%.9g ", value_of(matrix, r, c, k));
    assert_true(n < SIZE);
}

enum { ROWS = 24, VIEW, TRANSMISSION, DAYLIGHT, SKY };

static double product(int k, size_t sensor, size_t row)
{
    double sum = 0;
    for (size_t o = 0; o < OUT; o++)
        for (size_t i = 0; i < IN; i++)
            for (size_t p = 0; p < PATCHES; p++)
                sum += value_of(VIEW, sensor, o, k) * value_of(TRANSMISSION, o, i, k) *
                       value_of(DAYLIGHT, i, p, k) * value_of(SKY, p, row, k);
    return sum;
}

static double lux(size_t sensor, size_t row)
{
    return ORL_EFFICACY_LM_PER_W *
           (ORL_LUMA_R * product(0, sensor, row) + ORL_LUMA_G * product(1, sensor, row) +
            ORL_LUMA_B * product(2, sensor, row));
}

static char texts[FILES][SIZE];

static void write_texts(void)
{
    snprintf(texts[0], SIZE, "void plastic w 0 0 5 0 0 0 0 0\nw sphere stone 0 0 4 0 0 -50 .1\n");
    snprintf(texts[1], SIZE,
             "place made_up\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
             "weather_data_file_units 1\n",
             izmir.latitude_deg, -izmir.longitude_deg, -15 * izmir.time_zone_h);
    year_day(&izmir, 3, 22, texts[1], SIZE);
    write_matrix(VIEW, SENSORS, OUT, texts[2]);
    write_matrix(TRANSMISSION, OUT, IN, texts[3]);
    write_matrix(DAYLIGHT, IN, PATCHES, texts[4]);
    write_matrix(SKY, PATCHES, ROWS, texts[5]);
    write_matrix(SKY, PATCHES + 1, ROWS - 1, texts[6]);
}

static double no_clock(void *ctx)
{
    (void)ctx;
    return 0;
}

static int run_year(const struct orl_annual_request *request, struct orl_annual_result *ret_result,
                    struct orl_error *err)
{
    static const char *const names[FILES] = {scene_name, weather_name, view, transmission,
                                             daylight,   sky,          other};
    struct orl_file contents[FILES];
    for (int i = 0; i < FILES; i++)
        contents[i] = (struct orl_file){texts[i], strlen(texts[i]), NULL};
    struct orl_memory_files memory = {names, contents, FILES - 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    atomic_bool cancel = false;
    const struct orl_run_env env = {
        .pool = orl_thread_pool_start(2), .files = &files, .cancel = &cancel, .now_s = no_clock};
    const struct orl_annual_env annual = {.run = &env};
    const int code = orl_annual_run(request, &annual, ret_result, err);
    orl_thread_pool_stop(env.pool);
    return code;
}

static struct orl_sensor sensors[SENSORS] = {
    {{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}, {{2, 0, 0}, {0, 0, 1}}};
static struct orl_annual_grid grids[] = {{grid, 0, SENSORS}};

static struct orl_annual_request request_of(struct orl_matrix_term *terms, size_t n)
{
    write_texts();
    return (struct orl_annual_request){.scene_files = scene_names,
                                       .n_scene_files = 1,
                                       .weather_file = weather_name,
                                       .ground_reflectance = 0.2,
                                       .sensors = sensors,
                                       .n_sensors = SENSORS,
                                       .grids = grids,
                                       .n_grids = 1,
                                       .terms = terms,
                                       .n_terms = n};
}

static struct orl_matrix_term three_phase(void)
{
    return (struct orl_matrix_term){
        .grid = grid, .view = view, .transmission = transmission, .daylight = daylight, .sky = sky};
}

/* Rounding of floats: 2^-24 each of four factors, and of sums. */
static void assert_near(double found, double expected)
{
    if (!(fabs(found - expected) <= 1e-6 * fabs(expected)))
        fail_msg("%.9g lx for %.9g", found, expected);
}

static void test_three_phases(void **state)
{
    struct orl_matrix_term terms[3] = {three_phase(), three_phase(), three_phase()};
    struct orl_annual_result result;
    struct orl_error err = {0};
    (void)state;
    terms[2].subtract = true;
    /* one term; two equal terms; two and one more */
    for (size_t n = 1; n <= 3; n++) {
        const struct orl_annual_request request = request_of(terms, n);
        if (run_year(&request, &result, &err) < 0)
            fail_msg("%s", err.message);
        assert_int_equal(result.n_steps, ROWS);
        assert_true(result.n_columns > 6 && result.se == NULL);
        for (size_t i = 0; i < SENSORS; i++)
            for (size_t c = 0; c < result.n_columns; c++) {
                const struct orl_annual_step *step = &result.steps[result.step_of_column[c]];
                assert_near((double)result.total[i * result.n_columns + c],
                            (n == 2 ? 2 : 1) * lux(i, result.step_of_column[c]));
                /* In the open: all of the sun while it is up. */
                const double direct =
                    step->direct_normal_lx * sin(step->sun_altitude_deg * ORL_DEG_TO_RAD);
                assert_true(fabs((double)result.direct[i * result.n_columns + c] - direct) <=
                            0.01 * direct + 1e-3);
            }
        orl_annual_done(&result);
    }
}

/* Results below 0 after the subtraction are set to 0. */
static void test_coefficients_subtracted(void **state)
{
    struct orl_matrix_term term = {.coefficients = daylight, .sky = sky, .subtract = true};
    struct orl_annual_request request = request_of(&term, 1);
    struct orl_annual_result result;
    struct orl_error err = {0};
    (void)state;
    request.n_sensors = IN; /* the number of rows of that matrix */
    request.n_grids = 0;
    assert_int_equal(run_year(&request, &result, &err), 0);
    for (size_t i = 0; i < IN * result.n_columns; i++)
        assert_true(result.total[i] == 0);
    orl_annual_done(&result);
}

static void test_what_does_not_fit(void **state)
{
    static char none[] = "none";
    const struct orl_matrix_term good = three_phase();
    struct {
        struct orl_matrix_term term;
        const char *file, *says;
        int code;
    } cases[] = {{good, sky, "4 rows", ORL_ERR_RANGE},
                 {good, other, "23 columns", ORL_ERR_RANGE},
                 {{0}, daylight, "2 rows, but 3 are", ORL_ERR_RANGE},
                 {good, NULL, "is named 'none'", ORL_ERR_INVALID},
                 {good, NULL, "give a sky", ORL_ERR_INVALID},
                 {good, NULL, "give a sky", ORL_ERR_INVALID}};
    (void)state;
    cases[0].term.transmission = sky;
    cases[1].term.sky = other;
    cases[2].term = (struct orl_matrix_term){.coefficients = daylight, .sky = sky};
    cases[3].term.grid = none;
    cases[4].term.coefficients = view;
    cases[5].term.daylight = NULL;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_annual_request request = request_of(&cases[i].term, 1);
        struct orl_annual_result result;
        struct orl_error err = {0};
        assert_int_equal(run_year(&request, &result, &err), cases[i].code);
        if (cases[i].file)
            assert_string_equal(err.file, cases[i].file);
        if (!strstr(err.message, cases[i].says))
            fail_msg("case %zu: %s", i, err.message);
    }
}

/* Requests that matrices cannot satisfy are refused, and so are shades. */
static void test_what_is_not_told(void **state)
{
    struct orl_matrix_term term = three_phase();
    struct orl_annual_request request = request_of(&term, 1);
    struct orl_window_group group = {.name = grid};
    struct orl_report_request report_request;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_report_request_init(&report_request), 0);
    assert_int_equal(orl_report_request_validate(&request, &report_request, &err), 0);
    report_request.metrics[0].kind = ORL_METRIC_DF;
    assert_int_equal(orl_report_request_validate(&request, &report_request, &err), ORL_ERR_INVALID);
    report_request.metrics[0].kind = ORL_METRIC_DA;
    report_request.until = calloc(1, sizeof *report_request.until);
    assert_int_equal(orl_report_request_validate(&request, &report_request, &err), ORL_ERR_INVALID);
    orl_report_request_done(&report_request);
    request.coefficients = true;
    assert_int_equal(orl_annual_validate(&request, &err), ORL_ERR_INVALID);
    request.coefficients = false;
    request.groups = &group;
    request.n_groups = 1;
    assert_int_equal(orl_annual_validate(&request, &err), ORL_ERR_INVALID);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_three_phases),
        cmocka_unit_test(test_coefficients_subtracted),
        cmocka_unit_test(test_what_does_not_fit),
        cmocka_unit_test(test_what_is_not_told),
    };
    return cmocka_run_group_tests_name("annual_matrices", tests, NULL, NULL);
}
