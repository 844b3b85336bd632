/*
 * `oriel recipe`: each recipe leaves the files of its namesake in lbt-recipes, with values that
 * agree with closed forms, with each other, and with the job that they come from; and mistakes are
 * named.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

/* A court: a grid in the open, one under a canopy of 4 x 2 m at 1 m, and an eye. Its areas are 1, 2
 * and 0.5. */
static const char court[] =
    "{\"type\": \"Model\", \"identifier\": \"court\", \"version\": \"1.58.0\", \"units\": "
    "\"Meters\", \"tolerance\": 0.01, \"angle_tolerance\": 1.0,\n"
    "\"properties\": {\"type\": \"ModelProperties\", \"radiance\": {\"type\": "
    "\"ModelRadianceProperties\", \"sensor_grids\": [\n"
    "{\"type\": \"SensorGrid\", \"identifier\": \"open\", \"display_name\": \"In the open\", "
    "\"sensors\": [{\"pos\": [50, 0, 0.5], \"dir\": [0, 0, 1]}, {\"pos\": [50, 2, 0.5], \"dir\": "
    "[0, 0, -1]}, {\"pos\": [50, 4, 0.5], \"dir\": [0, -1, 0]}],\n"
    "\"mesh\": {\"type\": \"Mesh3D\", \"vertices\": [[50, 0, 0], [51, 0, 0], [51, 1, 0], [50, 1, "
    "0], [53, 0, 0], [53, 1, 0]], \"faces\": [[0, 1, 2, 3], [1, 4, 5, 2], [0, 1, 2]]}},\n"
    "{\"type\": \"SensorGrid\", \"identifier\": \"under\", \"group_identifier\": \"roof\", "
    "\"sensors\": [{\"pos\": [0, 0, 0], \"dir\": [0, 0, 1]}]},\n"
    "{\"type\": \"SensorGrid\", \"identifier\": \"eye\", \"sensors\": [{\"pos\": [50, 0, 1.2], "
    "\"dir\": [0, -1, 0]}]}],\n"
    "\"views\": [{\"type\": \"View\", \"identifier\": \"look\", \"position\": [50, -5, 1.5], "
    "\"direction\": [0, 1, 0], \"up_vector\": [0, 0, 1], \"view_type\": \"v\", \"h_size\": 60, "
    "\"v_size\": 60}]}},\n"
    "\"orphaned_shades\": [{\"type\": \"Shade\", \"identifier\": \"canopy\", \"geometry\": "
    "{\"type\": \"Face3D\", \"boundary\": [[-2, -1, 1], [2, -1, 1], [2, 1, 1], [-2, 1, 1]]}, "
    "\"properties\": {\"type\": \"ShadePropertiesAbridged\", \"radiance\": {\"type\": "
    "\"ShadeRadiancePropertiesAbridged\"}}}]}\n";

/* Clear hours at 9 and 15 o'clock around both equinoxes. */
static const char equinox[] =
    "place x\nlatitude 40\nlongitude 75\ntime_zone 75\nsite_elevation 0\n"
    "weather_data_file_units 1\n3 21 9.5 800 100\n3 21 15.5 800 100\n9 21 9.5 800 100\n"
    "9 21 15.5 800 100\n";

static int set_up(void **state)
{
    const struct cli_file files[] = {
        {"court.hbjson", court}, {"equinox.wea", equinox}, {NULL, NULL}};
    const int code = cli_desk_set_up(state, files);
    char *weather = cli_read_file("tests/fixtures", "weather.epw");
    assert_non_null(weather);
    cli_write_file(((struct cli_desk *)*state)->folder, "place.epw", weather);
    free(weather);
    return code;
}

/* ---- Running and reading --------------------------------------------------------------------- */

enum { MOST_OPTIONS = 16 };

/* Runs a recipe with options, each a name and a value; '@' stands for the test's folder. */
static void run(struct cli_desk *f, const char *recipe, const char *model,
                const char *const *options, int exit_code)
{
    static char values[MOST_OPTIONS][256];
    const char *args[MOST_OPTIONS + 8] = {"recipe", recipe, model, "-o", f->output, "-j", "2"};
    size_t n = 7;
    for (size_t i = 0; options[i]; i++) {
        snprintf(values[i], sizeof values[i], "%s%s", options[i][0] == '@' ? f->folder : "",
                 options[i] + (options[i][0] == '@'));
        args[n++] = values[i];
    }
    args[n] = NULL;
    cli_run(args, &f->result);
    if (f->result.exit_code != exit_code)
        fail_msg("%s: exit code %d: %s", recipe, f->result.exit_code, f->result.err);
}

#define RUN(f, recipe, ...)                                                                        \
    run(f, recipe, (f)->document, (const char *const[]){__VA_ARGS__, NULL}, 0)

static char *read_result(const struct cli_desk *f, const char *name)
{
    char *text = cli_read_file(f->output, name);
    if (!text)
        fail_msg("there is no file %s", name);
    return text;
}

static json_t *read_json(const struct cli_desk *f, const char *name)
{
    char *text = read_result(f, name);
    json_t *json = json_loads(text, 0, NULL);
    if (!json)
        fail_msg("%s is no JSON", name);
    free(text);
    return json;
}

/* Reads the numbers of a file; returns how many there are. */
static size_t read_numbers(const struct cli_desk *f, const char *name, double *ret_values,
                           size_t room)
{
    char *text = read_result(f, name), *at = text, *end;
    size_t n = 0;
    for (double value = strtod(at, &end); end != at; value = strtod(at, &end)) {
        assert_true(n < room);
        ret_values[n++] = value;
        at = end;
    }
    free(text);
    return n;
}

static void assert_exist(const struct cli_desk *f, const char *const *names)
{
    for (; *names; names++) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s", f->output, *names);
        if (access(path, R_OK) != 0)
            fail_msg("there is no file %s", *names);
    }
}

#define ASSERT_EXIST(f, ...) assert_exist(f, (const char *const[]){__VA_ARGS__, NULL})

static void assert_near(double value, double wanted, double within)
{
    if (!(fabs(value - wanted) <= within))
        fail_msg("%.6g, not %.6g within %g", value, wanted, within);
}

/* Reads a NumPy array of two dimensions; owned. */
static float *read_npy(const struct cli_desk *f, const char *name, int *ret_rows, int *ret_columns)
{
    char path[512];
    unsigned char head[10];
    snprintf(path, sizeof path, "%s/%s", f->output, name);
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("there is no file %s", name);
    assert_int_equal(fread(head, 1, sizeof head, file), sizeof head);
    const size_t length = head[8] + 256U * head[9];
    char *header = calloc(length + 1, 1);
    assert_int_equal(fread(header, 1, length, file), length);
    const char *shape = strstr(header, "'shape': (");
    assert_non_null(shape);
    assert_non_null(strstr(header, "<f4"));
    assert_int_equal(sscanf(shape, "'shape': (%d, %d", ret_rows, ret_columns), 2);
    const size_t n = (size_t)*ret_rows * (size_t)*ret_columns;
    float *values = malloc(n * sizeof *values);
    assert_int_equal(fread(values, sizeof *values, n, file), n);
    free(header);
    fclose(file);
    return values;
}

/* ---- Under one sky --------------------------------------------------------------------------- */

/* Radiance's skies change to the ground within some degrees of the horizon: weight of the sky by
 * height z (skybright.cal). */
static double sky_weight(double z)
{
    const double up = pow(z + 1.01, 10);
    return up / (up + 1 / up);
}

/* Integrates that sky for sensors that look up, down, and sideways. */
static void integrate_sky(double *ret_up, double *ret_down, double *ret_side)
{
    enum { STEPS = 20000 };
    *ret_up = *ret_down = *ret_side = 0;
    for (int i = 0; i < STEPS; i++) {
        const double z = -1 + 2 * (i + 0.5) / STEPS, w = sky_weight(z) * 2 / STEPS;
        *(z > 0 ? ret_up : ret_down) += 2 * M_PI * fabs(z) * w;
        *ret_side += 2 * sqrt(1 - z * z) * w;
    }
}

/* The canopy hides the form factor of a parallel rectangle above its middle (Howell's catalog,
 * B-3), of half sides 2 and 1 at height 1. */
static void test_sky_view_is_the_visible_share_of_the_sky(void **state)
{
    struct cli_desk *f = *state;
    const double a = 2, b = 1, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    const double canopy = 2 / M_PI * (a / p * atan(b / p) + b / q * atan(a / q));
    double up, down, side, values[4];
    integrate_sky(&up, &down, &side);
    RUN(f, "sky-view", "--samples", "16384");
    assert_int_equal(read_numbers(f, "results/sky_view/open.res", values, 4), 3);
    assert_near(values[0], 100, 0.1);
    assert_near(values[1], 100 * down / up, 0.1);
    assert_near(values[2], 100 * side / up, 0.15);
    assert_int_equal(read_numbers(f, "results/sky_view/roof_under.res", values, 4), 1);
    assert_near(values[0], 100 * (1 - canopy), 0.6);
    assert_non_null(strstr(f->result.err, "plan:"));
    json_t *info = read_json(f, "results/sky_view/grids_info.json");
    const json_t *grid = json_array_get(info, 1); /* in the order of their names */
    assert_string_equal(json_string_value(json_object_get(grid, "name")), "In the open");
    assert_string_equal(json_string_value(json_object_get(grid, "full_id")), "open");
    assert_int_equal(json_integer_value(json_object_get(grid, "count")), 3);
    grid = json_array_get(info, 2);
    assert_string_equal(json_string_value(json_object_get(grid, "group")), "roof");
    assert_string_equal(json_string_value(json_object_get(grid, "full_id")), "roof_under");
    json_decref(info);
}

/* In the open, the factor is 100 %, and a cloudy sky view is the factor without the ground. */
static void test_daylight_factors_are_percent_of_the_sky(void **state)
{
    struct cli_desk *f = *state;
    double values[4];
    RUN(f, "daylight-factor", "--samples", "4096", "--grid-filter", "open", "--cpu-count", "4");
    assert_int_equal(read_numbers(f, "results/open.res", values, 4), 3);
    assert_near(values[0], 100, 0.5);
    assert_near(values[1], 20, 1); /* the ground reflects a fifth */
    ASSERT_EXIST(f, "results/grids_info.json", "grid_summary.csv", "oriel/result.json");
    assert_non_null(strstr(f->result.err, "note: cpu-count: "));
    char *summary = read_result(f, "grid_summary.csv");
    assert_non_null(strstr(summary, "Sensor Grid,Sensor Grid ID,Mean,Minimum,Maximum,Uniformity"));
    assert_non_null(strstr(summary, "\nIn the open,open,"));
    free(summary);
    char *left_out = cli_read_file(f->output, "results/roof_under.res");
    assert_null(left_out);
}

static void test_point_in_time_takes_the_sky_of_its_text(void **state)
{
    struct cli_desk *f = *state;
    double values[4];
    RUN(f, "point-in-time-grid", "--sky", "illuminance 10000 -u -g 0", "--samples", "4096");
    assert_int_equal(read_numbers(f, "results/pit/open.res", values, 4), 3);
    assert_near(values[0], 10000, 50);
    ASSERT_EXIST(f, "results/pit/grids_info.json", "results/pit/roof_under.res");
}

static void test_views_become_radiance_pictures(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "point-in-time-view", "--sky", "illuminance 10000", "--resolution", "16");
    char *picture = read_result(f, "results/look.HDR");
    assert_memory_equal(picture, "#?RADIANCE", 10);
    assert_non_null(strstr(picture, "VIEW= -vtv -vp 50 -5 1.5"));
    free(picture);
    json_t *info = read_json(f, "results/views_info.json");
    assert_int_equal(json_array_size(info), 1);
    assert_string_equal(json_string_value(json_object_get(json_array_get(info, 0), "identifier")),
                        "look");
    json_decref(info);
}

/* The sensor that looks down lacks light, so that a third of the sensors fails, and 2 of the 3.5
 * square metres. */
static void test_leed_option_two_counts_areas(void **state)
{
    struct cli_desk *f = *state;
    double morning[4], both[4], lx[4];
    RUN(f, "leed-daylight-option-two", "--wea", "@/equinox.wea", "--samples", "64", "--grid-filter",
        "open", "--glare-control-devices", "no-glare-control");
    assert_int_equal(read_numbers(f, "simulation/9AM/results/open.res", lx, 4), 3);
    assert_int_equal(read_numbers(f, "results/9AM/open.res", morning, 4), 3);
    assert_int_equal(read_numbers(f, "results/combined/open.res", both, 4), 3);
    for (int i = 0; i < 3; i++)
        assert_true((morning[i] > 0) == (lx[i] > 300 && lx[i] < 3000));
    json_t *summary = read_json(f, "credit_summary.json");
    assert_near(json_number_value(json_object_get(summary, "total_floor_area")), 3.5, 1e-9);
    assert_near(json_number_value(json_object_get(summary, "percentage_passing_9AM")),
                100 * (morning[0] + 2 * morning[1] + 0.5 * morning[2]) / 3.5, 1e-6);
    assert_near(json_number_value(json_object_get(summary, "floor_area_passing")),
                both[0] + 2 * both[1] + 0.5 * both[2], 1e-9);
    json_decref(summary);
    ASSERT_EXIST(f, "results/space_summary.csv", "simulation/3PM/results/grids_info.json",
                 "simulation/model.hbjson", "oriel/2/result.json");
}

/* ---- Years ----------------------------------------------------------------------------------- */

/* Daylight autonomy from the hourly values of the same run, at 8 to 18 o'clock of both days. */
static void check_autonomy(const struct cli_desk *f, double lx)
{
    int rows, columns;
    double hours[64], da[4], lower[4], useful[4], upper[4];
    float *total =
        read_npy(f, "results/__static_apertures__/default/total/open.npy", &rows, &columns);
    assert_int_equal(rows, 3);
    assert_int_equal(read_numbers(f, "results/sun-up-hours.txt", hours, 64), columns);
    assert_int_equal(read_numbers(f, "metrics/da/open.da", da, 4), 3);
    read_numbers(f, "metrics/udi_lower/open.udi", lower, 4);
    read_numbers(f, "metrics/udi/open.udi", useful, 4);
    read_numbers(f, "metrics/udi_upper/open.udi", upper, 4);
    for (int i = 0; i < 3; i++) {
        double passing = 0, use = 0;
        for (int c = 0; c < columns; c++) {
            const double hour = fmod(hours[c], 24);
            if (hour > 8 && hour < 18)
                passing += (double)total[i * columns + c] >= lx;
        }
        use = 19; /* of 20 hours, one has no light in the file and does not count */
        assert_near(da[i], 100 * passing / use, 0.01);
        assert_near(lower[i] + useful[i] + upper[i], 100, 0.02);
    }
    free(total);
}

static void test_annual_daylight_agrees_with_its_hours(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "annual-daylight", "--wea", "@/place.epw", "--samples", "64", "--thresholds",
        "-t 20000 -ut 30000");
    check_autonomy(f, 20000);
    ASSERT_EXIST(f, "results/grids_info.json", "results/study_info.json", "grid_summary.csv",
                 "metrics/cda/roof_under.cda", "metrics/da/grids_info.json",
                 "metrics/udi_lower/vis_metadata.json", "metrics/udi_upper/vis_metadata.json");
    json_t *legend = read_json(f, "metrics/da/vis_metadata.json");
    assert_string_equal(json_string_value(json_object_get(legend, "type")),
                        "VisualizationMetaData");
    assert_string_equal(json_string_value(json_object_get(legend, "unit")), "%");
    json_decref(legend);
}

/* Inputs as lbt-recipes writes them: files beside the file, numbers and names with '-'. */
static void test_inputs_come_from_a_file(void **state)
{
    struct cli_desk *f = *state;
    char path[256];
    const char *const args[] = {
        "recipe", "annual_daylight_enhanced", "--inputs", path, "-o", f->output, NULL};
    cli_write_file(f->folder, "inputs.json",
                   "{\"model\": \"court.hbjson\", \"wea\": \"place.epw\", \"north\": 0.0, "
                   "\"timestep\": 1, \"cpu-count\": 2, \"radiance-parameters\": \"-ab 2\", "
                   "\"thresholds\": \"-t 300\", \"samples\": 16}");
    snprintf(path, sizeof path, "%s/inputs.json", f->folder);
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    ASSERT_EXIST(f, "results/__static_apertures__/default/direct/eye.npy",
                 "results/grid_states.json", "metrics/da/eye.da", "output_model.hbjson");
    assert_non_null(strstr(f->result.err, "note: radiance-parameters: "));
}

/* A sensor that looks up in the open sees the sun in all hours, and one that looks down in none. */
static void test_sun_hours_are_those_of_the_sun(void **state)
{
    struct cli_desk *f = *state;
    double hours[64], sums[4], marks[256];
    RUN(f, "direct-sun-hours", "--wea", "@/place.epw");
    const size_t columns = read_numbers(f, "results/direct_sun_hours/sun-up-hours.txt", hours, 64);
    assert_in_range(columns, 20, 24);
    assert_int_equal(read_numbers(f, "results/cumulative/open.res", sums, 4), 3);
    assert_near(sums[0], (double)columns, 0);
    assert_near(sums[1], 0, 0);
    assert_int_equal(read_numbers(f, "results/direct_sun_hours/open.ill", marks, 256), 3 * columns);
    double south = 0;
    for (size_t c = 0; c < columns; c++)
        south += marks[2 * columns + c];
    assert_near(sums[2], south, 0);
    assert_int_equal(read_numbers(f, "results/cumulative/roof_under.res", sums, 4), 1);
    assert_true(sums[0] > 0 && sums[0] < (double)columns);
    ASSERT_EXIST(f, "results/direct_sun_hours/timestep.txt", "results/cumulative/grids_info.json");
}

static void test_glare_autonomy_agrees_with_its_hours(void **state)
{
    struct cli_desk *f = *state;
    double dgp[64], hours[64], autonomy[4];
    RUN(f, "imageless-annual-glare", "--wea", "@/place.epw", "--samples", "64", "--grid-filter",
        "eye", "--glare-threshold", "0.5");
    const size_t columns = read_numbers(f, "results/sun-up-hours.txt", hours, 64);
    assert_int_equal(read_numbers(f, "results/eye.dgp", dgp, 64), columns);
    assert_int_equal(read_numbers(f, "metrics/ga/eye.ga", autonomy, 4), 1);
    double above = 0, most = 0;
    for (size_t c = 0; c < columns; c++) {
        above += dgp[c] > 0.5;
        most = fmax(most, dgp[c]);
    }
    assert_true(above > 0 && most <= 1);
    assert_near(autonomy[0], 100 * (1 - above / 19), 0.01);
    ASSERT_EXIST(f, "metrics/ga/grids_info.json", "results/grids_info.json");
}

/* The daylight hours of a file of two days are those with light. */
static void test_en17037_has_shares_of_areas(void **state)
{
    struct cli_desk *f = *state;
    double da[4], share[2], level[4];
    RUN(f, "annual-daylight-en17037", "--epw", "@/place.epw", "--samples", "64", "--grid-filter",
        "open");
    assert_int_equal(read_numbers(f, "en17037/da/Target Illuminance 300/open.da", da, 4), 3);
    assert_int_equal(read_numbers(f, "en17037/sda/Target Illuminance 300/open.sda", share, 2), 1);
    assert_near(share[0], 100 * ((da[0] >= 50) + 2 * (da[1] >= 50) + 0.5 * (da[2] >= 50)) / 3.5,
                0.01);
    assert_int_equal(
        read_numbers(f, "en17037/compliance_level/Target Illuminance/open.pf", level, 4), 3);
    json_t *summary = read_json(f, "en17037/summary.json");
    const json_t *target = json_object_get(summary, "Target Illuminance 300");
    assert_near(json_number_value(json_object_get(target, "sDA")), share[0], 0.01);
    assert_true(json_is_true(json_object_get(target, "passes")) == (share[0] >= 50));
    assert_near(json_number_value(json_object_get(summary, "Total Floor Area")), 3.5, 1e-9);
    json_decref(summary);
    ASSERT_EXIST(f, "en17037/summary_grid.json", "daylight_hours.csv", "daylight_hours.json",
                 "en17037/da/Minimum Illuminance 500/vis_metadata.json", "metrics/da/open.da");
}

static void test_breeam_counts_hours_of_the_year(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "breeam-daylight-4b", "--wea", "@/place.epw", "--samples", "64");
    json_t *grids = read_json(f, "breeam_summary/grid_summary.json");
    int rows, columns;
    double average_h = 0;
    float *total =
        read_npy(f, "results/__static_apertures__/default/total/open.npy", &rows, &columns);
    for (int c = 0; c < columns; c++)
        average_h += (total[c] + total[columns + c] + total[2 * columns + c]) / 3 >= 300;
    free(total);
    const json_t *grid = json_object_get(grids, "open");
    assert_near(json_number_value(json_object_get(grid, "average-illuminance-hours")), average_h,
                0);
    assert_string_equal(json_string_value(json_object_get(grid, "program-type")),
                        "BREEAM::Office_buildings::Occupied_spaces");
    json_decref(grids);
    json_t *summary = read_json(f, "breeam_summary/summary.json");
    const json_t *building = json_array_get(summary, 0);
    assert_false(json_is_true(json_object_get(building, "comply"))); /* two days of a year */
    assert_int_equal(json_integer_value(json_object_get(building, "credits")), 0);
    json_decref(summary);
    ASSERT_EXIST(f, "breeam_summary/program_summary.json", "breeam_summary/pass_fail/open.pf",
                 "breeam_summary/minimum_illuminance_sensors.json");
}

/* Without windows there are no blinds: hours with sun are listed, and there are no credits. */
static void test_leed_option_one_tells_uncontrolled_sun(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "leed-daylight-option-one", "--wea", "@/place.epw", "--samples", "16");
    json_t *summary = read_json(f, "leed_summary/summary.json"),
           *hours = read_json(f, "leed_summary/states_schedule_err.json");
    assert_int_equal(json_integer_value(json_object_get(summary, "credits")), 0);
    assert_non_null(json_object_get(summary, "note"));
    assert_true(json_array_size(json_object_get(hours, "open")) > 0);
    json_decref(summary);
    json_decref(hours);
}

/* Windows get blinds: with them closed there is less light than with them open, and the year by
 * LM-83's rule lies between. */
static void test_blinds_close_against_the_sun(void **state)
{
    static const char model[] = "tests/fixtures/honeybee/two_rooms.hbjson";
    struct cli_desk *f = *state;
    run(f, "leed-daylight-option-one", model,
        (const char *const[]){"--wea", "@/place.epw", "--samples", "64", NULL}, 0);
    json_t *grids = read_json(f, "leed_summary/summary_grid.json"),
           *states = read_json(f, "leed_summary/states_schedule.json"), *grid;
    const char *name;
    assert_true(json_object_size(states) > 0);
    json_object_foreach(grids, name, grid)
    {
        const double up = json_number_value(json_object_get(grid, "sda_blinds_up")),
                     sda = json_number_value(json_object_get(grid, "sda")),
                     down = json_number_value(json_object_get(grid, "sda_blinds_down"));
        assert_true(up >= sda && sda >= down);
    }
    json_object_foreach(states, name, grid)
    {
        const json_t *values = json_object_get(grid, "values");
        const json_t *type = json_object_get(json_object_get(grid, "header"), "data_type");
        assert_int_equal(json_array_size(values), 8760);
        assert_string_equal(json_string_value(json_object_get(type, "type")), "GenericDataType");
        assert_non_null(json_object_get(type, "base_unit"));
    }
    json_decref(grids);
    json_decref(states);
    ASSERT_EXIST(f, "leed_summary/results/da/vis_metadata.json", "leed_summary/grids_info.json",
                 "leed_summary/results/ase_hours_above/grids_info.json",
                 "leed_summary/datacollections/ase_percentage_above/grids_info.json",
                 "leed_summary/pass_fail/DA/grids_info.json",
                 "leed_summary/pass_fail/ASE/grids_info.json");
}

static void test_well_has_both_features(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "well-daylight", "--epw", "@/place.epw", "--samples", "16");
    json_t *l01 = read_json(f, "well_summary/l01_well_summary.json"),
           *l06 = read_json(f, "well_summary/l06_well_summary.json"),
           *version = read_json(f, "well_summary/well_version.json");
    assert_int_equal(json_array_size(l01), 2);
    assert_false(json_is_true(json_object_get(json_array_get(l01, 0), "comply")));
    assert_true(json_is_boolean(json_object_get(json_array_get(l01, 1), "comply")));
    assert_int_equal(json_integer_value(json_object_get(json_array_get(l06, 0), "points")), 0);
    assert_non_null(json_object_get(version, "L06"));
    json_decref(l01);
    json_decref(l06);
    json_decref(version);
    ASSERT_EXIST(f, "well_summary/ies_lm/l06_ies_lm_summary/ies_lm_summary.json",
                 "well_summary/ies_lm/l01_ies_lm_summary/results/da/open.da",
                 "well_summary/ies_lm/pass_fail/L06/open.pf", "daylight_hours.json",
                 "well_summary/en17037/summary.json");
}

/* ---- Mistakes -------------------------------------------------------------------------------- */

static void test_mistakes_are_named(void **state)
{
    static const struct {
        const char *recipe, *options[5], *says;
        int exit_code;
    } cases[] = {
        {"annual-dayligt", {NULL}, "did you mean annual-daylight?", 2},
        {"annual-irradiance", {NULL}, "no irradiance of the whole solar spectrum", 2},
        {"annual-daylight", {NULL}, "needs the input 'wea'", 1},
        {"annual-daylight", {"--wea", "nowhere.epw", NULL}, "nowhere.epw", 1},
        {"annual-daylight", {"--wea", "@/court.hbjson", NULL}, "no weather file", 1},
        {"annual-daylight", {"--wae", "x", NULL}, "did you mean --wea?", 2},
        {"annual-daylight",
         {"--wea", "@/place.epw", "--thresholds", "-x 3", NULL},
         "-t, -lt and -ut are expected",
         1},
        {"daylight-factor", {"--grid-filter", "garden*", NULL}, "no grids that match", 1},
        {"point-in-time-grid", {"--sky", "sunny", NULL}, "a sky begins with", 1},
    };
    struct cli_desk *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run(f, cases[i].recipe, f->document, cases[i].options, cases[i].exit_code);
        if (!strstr(f->result.err, cases[i].says))
            fail_msg("expected \"%s\" in:\n%s", cases[i].says, f->result.err);
    }
    run(f, "daylight-factor", "README.md", (const char *const[]){NULL}, 1);
    run(f, "daylight-factor", "tests/fixtures/honeybee/none.zip", (const char *const[]){NULL}, 1);
    assert_non_null(strstr(f->result.err, "unpack the zip"));
    cli_write_file(f->folder, "other.json", "{\"type\": \"Room\"}");
    char path[256];
    snprintf(path, sizeof path, "%s/other.json", f->folder);
    run(f, "daylight-factor", path, (const char *const[]){NULL}, 1);
    assert_non_null(strstr(f->result.err, "no Honeybee model"));
}

/* Results of another run in the same folder are replaced; other programs' files are left alone. */
static void test_a_second_run_replaces_the_first(void **state)
{
    struct cli_desk *f = *state;
    RUN(f, "sky-view", "--samples", "16");
    RUN(f, "daylight-factor", "--samples", "16");
    ASSERT_EXIST(f, "results/open.res");
    char *old = cli_read_file(f->output, "results/sky_view/open.res");
    assert_null(old);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_sky_view_is_the_visible_share_of_the_sky, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_daylight_factors_are_percent_of_the_sky, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_point_in_time_takes_the_sky_of_its_text, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_views_become_radiance_pictures, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_leed_option_two_counts_areas, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_annual_daylight_agrees_with_its_hours, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_inputs_come_from_a_file, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_sun_hours_are_those_of_the_sun, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_glare_autonomy_agrees_with_its_hours, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_en17037_has_shares_of_areas, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_breeam_counts_hours_of_the_year, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_leed_option_one_tells_uncontrolled_sun, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_blinds_close_against_the_sun, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_well_has_both_features, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes_are_named, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_second_run_replaces_the_first, set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
