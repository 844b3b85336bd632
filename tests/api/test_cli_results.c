/* Results that `oriel run` leaves to look at: tables, maps of grids, and DGP. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

/* A floor under a uniform sky of 10000 lx, with a roof over its half. */
static const char scene_text[] = "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void glow sky_glow\n0\n0\n4 17.78 17.78 17.78 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  4 0 0  4 4 0  0 4 0\n"
                                 "grey polygon roof\n0\n0\n12 0 0 3  0 4 3  2 4 3  2 0 3\n";
#define SENSORS "0.5 1 0.8 0 0 1\n1.5 1 0.8 0 0 1\n2.5 1 0.8 0 0 1\n3.5 1 0.8 0 0 1\n"

#define JOB(SENSORS_OF)                                                                            \
    "{\"scene\": {\"files\": [\"room.rad\"]}, \"technique\": \"backward\","                        \
    " \"gather_samples\": 256, " SENSORS_OF "}"

static int set_up(void **state)
{
    static const struct cli_file files[] = {
        {"job.json",
         JOB("\"grids\": [{\"name\": \"desks\", \"sensors\": {\"file\": \"desks.pts\"}},"
             " {\"name\": \"upper/rail\", \"sensors\": [[1, 1, 3.5, 0, 0, 1]]}]")},
        {"room.rad", scene_text},
        {"desks.pts", SENSORS},
        {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("\"%s\" is not in: %s", wanted, text);
}

static json_t *load_result(const struct cli_desk *f)
{
    char *text = cli_read_file(f->output, "result.json");
    assert_non_null(text);
    json_t *json = json_loads(text, 0, NULL);
    assert_non_null(json);
    free(text);
    return json;
}

static void run_document(struct cli_desk *f)
{
    const char *const args[] = {"run", f->document, "-o", f->output, "--threads", "1", NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
}

static bool is_picture(const struct cli_desk *f, const char *name)
{
    char path[256], begin[8] = "";
    snprintf(path, sizeof path, "%s/%s", f->output, name);
    FILE *file = fopen(path, "rb");
    const bool read = file && fread(begin, 1, sizeof begin, file) == sizeof begin;
    if (file)
        fclose(file);
    return read && memcmp(begin, "\x89PNG\r\n\x1a\n", sizeof begin) == 0;
}

static double number(const json_t *holder, const char *key)
{
    return json_number_value(json_object_get(holder, key));
}

static void assert_near(double value, double wanted, double most)
{
    if (!(fabs(value - wanted) <= most))
        fail_msg("%g is not %g, within %g", value, wanted, most);
}

/* The figures of a grid are those of its sensors. */
static void assert_summary(const json_t *result, const json_t *grid)
{
    const json_t *summary = json_object_get(grid, "summary");
    const json_t *interval = json_object_get(summary, "interval_95_lx");
    const size_t first = (size_t)number(grid, "first"), count = (size_t)number(grid, "count");
    double sum = 0, low = 0, least = INFINITY, most = 0, above = 0;
    for (size_t i = first; i < first + count; i++) {
        const json_t *sensor = json_array_get(json_object_get(result, "sensors"), i);
        const double lx = number(sensor, "illuminance_lx");
        sum += lx;
        low += json_number_value(json_array_get(json_object_get(sensor, "interval_95_lx"), 0));
        least = fmin(least, lx);
        most = fmax(most, lx);
        above += lx >= 300;
    }
    const double n = (double)count;
    assert_near(number(summary, "mean_lx"), sum / n, 1e-6 * sum);
    assert_near(json_number_value(json_array_get(interval, 0)), low / n, 1e-6 * sum);
    assert_near(number(summary, "minimum_lx"), least, 1e-6 * sum);
    assert_near(number(summary, "maximum_lx"), most, 1e-6 * sum);
    assert_near(number(summary, "share_300"), above / n, 1e-9);
    assert_near(number(summary, "uniformity"), least * n / sum, 1e-6);
}

static void test_grids_leave_a_map_and_a_table(void **state)
{
    struct cli_desk *f = *state;
    char wanted[400];
    run_document(f);
    json_t *result = load_result(f);
    const json_t *grid = json_array_get(json_object_get(result, "grids"), 0);
    assert_string_equal(json_string_value(json_object_get(grid, "map")), "results/desks.png");
    assert_true(is_picture(f, "results/desks.png"));
    assert_summary(result, grid);
    /* One sensor makes no plane, so the second grid has no map. */
    grid = json_array_get(json_object_get(result, "grids"), 1);
    assert_null(json_object_get(grid, "map"));
    assert_summary(result, grid);
    assert_says(f->result.out, "grid          sensors   mean lx    error    min lx    max lx");
    snprintf(wanted, sizeof wanted, "%-12s %8d ", "desks", 4);
    assert_says(f->result.out, wanted);
    assert_says(f->result.out, "upper/rail          1 ");
    snprintf(wanted, sizeof wanted, "%s/results/desks.png\n%s/sensors.csv\n%s/result.json\n",
             f->output, f->output, f->output);
    assert_says(f->result.out, wanted);
    assert_null(strstr(f->result.out, "\033"));
    json_decref(result);
}

/* A line per sensor: position, direction, value, errors, and the name of its grid. */
static void test_all_sensors_are_one_table(void **state)
{
    struct cli_desk *f = *state;
    double v[8];
    run_document(f);
    json_t *result = load_result(f);
    char *csv = cli_read_file(f->output, "sensors.csv");
    assert_non_null(csv);
    assert_says(csv, "x,y,z,dx,dy,dz,illuminance_lx,standard_error_lx,");
    assert_says(csv, ",unreliable,grid\n");
    const char *last = strstr(csv, "\n1,1,3.5,0,0,1,");
    assert_non_null(last);
    assert_int_equal(sscanf(last, " %lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3, v + 4,
                            v + 5, v + 6, v + 7),
                     8);
    const json_t *sensor = json_array_get(json_object_get(result, "sensors"), 4);
    assert_near(v[6], number(sensor, "illuminance_lx"), 1e-4 * v[6]);
    assert_near(v[7], number(sensor, "standard_error_lx"), 1e-2 * v[7] + 1e-9);
    assert_says(last, ",upper/rail\n");
    free(csv);
    json_decref(result);
}

static void test_sensors_without_grids(void **state)
{
    struct cli_desk *f = *state;
    cli_write_file(f->folder, "job.json", JOB("\"sensors\": {\"file\": \"desks.pts\"}"));
    run_document(f);
    assert_true(is_picture(f, "sensors.map.png"));
    assert_says(f->result.out, "all sensors         4 ");
    json_t *result = load_result(f);
    const json_t *files = json_object_get(result, "sensor_files");
    assert_string_equal(json_string_value(json_object_get(files, "csv")), "sensors.csv");
    assert_null(json_object_get(files, "res"));
    assert_true(number(json_object_get(result, "summary"), "mean_lx") > 1000);
    char *csv = cli_read_file(f->output, "sensors.csv");
    assert_non_null(csv);
    assert_null(strstr(csv, "grid"));
    free(csv);
    json_decref(result);
}

/* ---- Projects -------------------------------------------------------------------------------- */

/* Writes a project of Radiance files with a grid and two views. */
static void write_project(const struct cli_desk *f, const char *scene)
{
    static const char *const folders[] = {"model", "model/scene", "model/grid", "model/view"};
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        char path[160];
        snprintf(path, sizeof path, "%s/%s", f->folder, folders[i]);
        assert_int_equal(mkdir(path, 0700), 0);
    }
    cli_write_file(f->folder, "model/scene/room.rad", scene);
    cli_write_file(f->folder, "model/grid/desks.pts", SENSORS);
    cli_write_file(f->folder, "model/view/eye.vf",
                   "rvu -vth -vp 3 2 1.2 -vd -1 0 0 -vu 0 0 1 -vh 180 -vv 180\n");
    cli_write_file(f->folder, "model/view/plain.vf",
                   "rvu -vtv -vp 3 2 1.2 -vd -1 0 0 -vu 0 0 1 -vh 40 -vv 40\n");
}

static void test_fisheye_views_have_dgp(void **state)
{
    struct cli_desk *f = *state;
    char model[160];
    write_project(f, scene_text);
    snprintf(model, sizeof model, "%s/model", f->folder);
    const char *const written[] = {"plan", model, "--json", NULL};
    cli_run(written, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    /* The planner says how many views are rated. */
    assert_says(f->result.out, "1 of 2 views asks for a glare metric");
}

static void test_dgp_is_told_with_class_and_interval(void **state)
{
    struct cli_desk *f = *state;
    double value, low, high;
    char class_name[32];
    cli_write_file(f->folder, "job.json",
                   JOB("\"views\": [{\"name\": \"eye\", \"metrics\": [\"dgp\"], \"width\": 48,"
                       " \"height\": 48, \"view\": \"-vth -vp 3 2 1.2 -vd -1 0 0 -vu 0 0 1"
                       " -vh 180 -vv 180\"}]"));
    run_document(f);
    assert_int_equal(sscanf(f->result.out, "view eye: DGP %lf [%lf, %lf], %31s glare\n", &value,
                            &low, &high, class_name),
                     4);
    assert_true(low <= value && value <= high && value > 0.1);
    json_t *result = load_result(f);
    const json_t *glare =
        json_object_get(json_array_get(json_object_get(result, "views"), 0), "glare");
    assert_string_equal(json_string_value(json_object_get(glare, "class")), class_name);
    json_decref(result);
}

/* ---- oriel project --------------------------------------------------------------------------- */

static void list_project(struct cli_desk *f, int code, const char *json)
{
    char model[160];
    snprintf(model, sizeof model, "%s/model", f->folder);
    const char *const args[] = {"project", model, json, NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != code)
        fail_msg("exit code %d: %s%s", f->result.exit_code, f->result.out, f->result.err);
}

static void test_project_is_a_table(void **state)
{
    struct cli_desk *f = *state;
    write_project(f, scene_text);
    list_project(f, 0, NULL);
    assert_says(f->result.out, "units     those of its files, which name none\n");
    assert_says(f->result.out, "scene     1 file\n");
    assert_says(f->result.out, "\ndesks                                  4\n");
    assert_says(f->result.out, "\neye                              fisheye (with DGP)\n");
    assert_says(f->result.out, "\nplain                            perspective\n");
    const char *const model[] = {"project", "tests/fixtures/honeybee/two_rooms.hbjson", NULL};
    cli_run(model, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_says(f->result.out, "units     Meters\n");
    assert_says(f->result.out, "0_south_glass*, 1_south_glass\n");
}

/* All missing files are listed at once, and the exit code is 1. */
static void test_missing_files_are_listed(void **state)
{
    struct cli_desk *f = *state;
    char scene[2048];
    snprintf(scene, sizeof scene,
             "%s!xform -t 1 0 0 model/scene/chair.mat\n"
             "void BSDF blind\n6 0 model/bsdf/blind.xml 0 0 1 .\n0\n0\n"
             "void BSDF screen\n6 0 model/bsdf/screen.xml 0 0 1 .\n0\n0\n"
             "blind polygon a\n0\n0\n9 0 0 1 1 0 1 1 1 1\n"
             "screen polygon b\n0\n0\n9 0 0 2 1 0 2 1 1 2\n",
             scene_text);
    write_project(f, scene);
    list_project(f, 1, NULL);
    assert_says(f->result.out, "\nmissing file");
    assert_says(f->result.out, "\nmodel/scene/chair.mat\n");
    assert_says(f->result.out, "\nmodel/bsdf/blind.xml\n");
    assert_says(f->result.out, "\nmodel/bsdf/screen.xml\n");
    list_project(f, 1, "--json");
    json_t *project = json_loads(f->result.out, 0, NULL);
    assert_int_equal(json_array_size(json_object_get(project, "missing")), 3);
    json_decref(project);
}

static void test_an_unreadable_scene_is_reported(void **state)
{
    struct cli_desk *f = *state;
    write_project(f, "void plastic grey\n0\n0\n5 0.5 0.5 x 0 0\n");
    list_project(f, 1, NULL);
    assert_says(f->result.err, "room.rad:4");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_grids_leave_a_map_and_a_table, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_all_sensors_are_one_table, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_sensors_without_grids, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_fisheye_views_have_dgp, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_dgp_is_told_with_class_and_interval, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_project_is_a_table, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_missing_files_are_listed, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_an_unreadable_scene_is_reported, set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
