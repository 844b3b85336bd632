/*
 * Work whose length depends on the input polls for cancellation. The number of polls between its
 * begin and its end grows with the input. A cancel at any poll ends the work early and leaves no
 * file. Counts do not depend on the machine's speed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/io/out_file.h"
#include <oriel/annual/annual_report.h>

#include "base/statistics/numeric.h"
#include "bsdf/make/trees/tree_builder.h"
#include "photon/map/map.h"
#include "run/request/job_inputs.h"
#include "scene/generate/solid/solids.h"
#include "scene/geometry/coincidence/coincident.h"
#include "support/scratch.h"

static int polls;
static int cancel_at; /* the poll from which on the result is true; negative: never */
static const atomic_bool flag;

/* Replaces core/base/threads/cancel.c: the core's polls call this. */
bool orl_is_cancelled(const atomic_bool *cancel)
{
    return cancel && polls++ >= cancel_at && cancel_at >= 0;
}

static void begin_count(int at)
{
    polls = 0;
    cancel_at = at;
}

/* ---- Result files ---------------------------------------------------------------------------- */

enum { ROWS = 2000, COLUMNS = 3000, LONG = ROWS * COLUMNS };
static float *values;

static int write_npy(struct orl_error *err)
{
    return orl_npy_write(scratch_path("file"), values, ROWS, COLUMNS, &flag, err);
}

static int write_float(struct orl_error *err)
{
    return orl_matrix_write(scratch_path("file"), values, ROWS, COLUMNS, false, &flag, err);
}

/* Numbers as text take longer: fewer of them. */
static int write_ascii(struct orl_error *err)
{
    return orl_matrix_write(scratch_path("file"), values, ROWS / 10, COLUMNS / 10, true, &flag,
                            err);
}

static int write_coefficients(struct orl_error *err)
{
    return orl_coefficients_write(scratch_path("file"), values, ROWS, COLUMNS, &flag, err);
}

static int write_sensors(struct orl_error *err)
{
    enum { SENSORS = 1000 };
    static struct orl_sensor sensors[SENSORS];
    struct orl_annual_grid grid = {.name = "g", .count = SENSORS};
    const struct orl_annual_report report = {.grids = &grid, .n_grids = 1, .n_sensors = SENSORS};
    return orl_annual_sensors_csv(scratch_path("file"), &report, sensors, &flag, err);
}

static const struct {
    const char *name;
    int (*write)(struct orl_error *err);
    int least; /* minimum number of polls */
} files[] = {{"NPY", write_npy, 5},
             {"matrix", write_float, 5},
             {"text matrix", write_ascii, ROWS / 10},
             {"coefficients", write_coefficients, LONG / 4096},
             {"sensors", write_sensors, 1000}};

static void test_files(void **state)
{
    struct orl_error err;
    (void)state;
    values = calloc(LONG, sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        begin_count(-1);
        assert_int_equal(files[i].write(&err), 0);
        print_message("# %s: %d polls\n", files[i].name, polls);
        assert_true(polls >= files[i].least);
        assert_int_equal(unlink(scratch_path("file")), 0);
        const int at[] = {0, polls / 2, polls - 1};
        for (int k = 0; k < 3; k++) {
            begin_count(at[k]);
            assert_int_equal(files[i].write(&err), ORL_ERR_CANCELLED);
            assert_int_equal(access(scratch_path("file"), F_OK), -1);
            assert_int_equal(access(scratch_path("file.part"), F_OK), -1);
            /* The writer ended within three polls of the cancellation. */
            assert_true(polls <= at[k] + 3);
        }
    }
    free(values);
}

/* ---- Reports of a year ----------------------------------------------------------------------- */

enum { YEAR_GRIDS = 300, YEAR_SENSORS = 2 * YEAR_GRIDS, YEAR_COLUMNS = 12, NOON = 12 };
static struct orl_annual_grid year_grids[YEAR_GRIDS];

static void name_grids(struct orl_annual_request *request)
{
    static char name[] = "g";
    for (size_t g = 0; g < YEAR_GRIDS; g++)
        year_grids[g] = (struct orl_annual_grid){name, 2 * g, 2};
    *request = (struct orl_annual_request){
        .grids = year_grids, .n_grids = YEAR_GRIDS, .n_sensors = YEAR_SENSORS};
}

/* A year in which the sun shines on the first of each month at noon. */
static void make_year(struct orl_annual_result *result)
{
    static struct orl_annual_step steps[YEAR_COLUMNS];
    static uint32_t step_of_column[YEAR_COLUMNS];
    static float lx[YEAR_SENSORS * YEAR_COLUMNS], se[YEAR_SENSORS * YEAR_COLUMNS];
    for (uint32_t k = 0; k < YEAR_COLUMNS; k++) {
        steps[k] = (struct orl_annual_step){
            .month = (int)k + 1, .day = 1, .hour = NOON + 0.5, .column = k, .global_lx = 1e4};
        step_of_column[k] = k;
    }
    for (size_t i = 0; i < YEAR_SENSORS * YEAR_COLUMNS; i++) {
        lx[i] = (float)(i % 600);
        se[i] = 50;
    }
    *result = (struct orl_annual_result){.n_steps = YEAR_COLUMNS,
                                         .steps = steps,
                                         .step_of_column = step_of_column,
                                         .n_columns = YEAR_COLUMNS,
                                         .n_sensors = YEAR_SENSORS,
                                         .total = lx,
                                         .direct = lx,
                                         .se = se};
}

/* Compares the series that a picture of the year shows with means computed here. */
static void expect_series(const struct orl_annual_report *report,
                          const struct orl_annual_result *result)
{
    float *series = calloc(report->year.steps.count, sizeof *series);
    assert_non_null(series);
    begin_count(-1);
    assert_int_equal(
        orl_annual_series_of(report, result, ORL_ALL_GRIDS, ORL_SERIES_MEAN, 0, &flag, series), 0);
    assert_int_equal(polls, YEAR_SENSORS);
    for (size_t k = 0; k < YEAR_COLUMNS; k++) {
        double mean = 0, area = 0;
        for (size_t i = 0; i < YEAR_SENSORS; i++) {
            mean += report->area[i] * (double)result->total[i * YEAR_COLUMNS + k];
            area += report->area[i];
        }
        assert_float_equal(series[report->year.step_of_column[k]], (float)(mean / area), 1e-3F);
    }
    for (int at = 0; at < YEAR_SENSORS; at += YEAR_SENSORS / 20) {
        begin_count(at);
        assert_int_equal(orl_annual_series_of(report, result, ORL_ALL_GRIDS, ORL_SERIES_SHARE, 300,
                                              &flag, series),
                         ORL_ERR_CANCELLED);
        assert_int_equal(polls, at + 1);
    }
    free(series);
}

/* Each of these figures visits every sensor twice: by its grid and in all grids together. */
static void test_reports(void **state)
{
    struct orl_annual_request request;
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_error err = {0};
    (void)state;
    name_grids(&request);
    make_year(&result);
    assert_int_equal(orl_report_request_init(&report_request), 0);
    report_request.targets = calloc(1, sizeof *report_request.targets);
    assert_non_null(report_request.targets);
    assert_int_equal(orl_annual_target_parse("sDA300/50 >= 55 %", report_request.targets, &err), 0);
    report_request.n_targets = 1;
    begin_count(-1);
    assert_int_equal(orl_annual_report_make(&request, &result, &report_request, NULL, &flag, NULL,
                                            &report, &err),
                     0);
    const int all = polls;
    expect_series(&report, &result);
    orl_annual_report_done(&report);
    print_message("# report of %d sensors: %d polls\n", YEAR_SENSORS, all);
    assert_true(all >= (1 + 3 * 2) * YEAR_SENSORS);
    for (int at = 0; at < all; at += all / 20) {
        begin_count(at);
        assert_int_equal(orl_annual_report_make(&request, &result, &report_request, NULL, &flag,
                                                NULL, &report, &err),
                         ORL_ERR_CANCELLED);
        assert_int_equal(polls, at + 1);
    }
    orl_report_request_done(&report_request);
}

/* Sensors in the document itself: a poll at each grid. */
static void test_grids(void **state)
{
    static char *names[YEAR_GRIDS];
    struct orl_annual_request request;
    struct orl_files none = {.ctx = NULL};
    struct orl_error err = {0};
    (void)state;
    name_grids(&request);
    request.sensors = calloc(YEAR_SENSORS, sizeof *request.sensors);
    begin_count(YEAR_GRIDS / 2);
    assert_int_equal(orl_annual_grids_read(&request, names, &none, &flag, &err), ORL_ERR_CANCELLED);
    assert_int_equal(polls, YEAR_GRIDS / 2 + 1);
    begin_count(-1);
    assert_int_equal(orl_annual_grids_read(&request, names, &none, &flag, &err), 0);
    assert_int_equal(polls, YEAR_GRIDS);
    free(request.sensors);
}

/* ---- A BSDF's tree as text ------------------------------------------------------------------- */

static void test_trees(void **state)
{
    enum { FAN = ORL_GONIO_MAX_BRANCHING, BRANCHES = 1 + FAN };
    struct orl_gonio_branch branches[BRANCHES] = {{{{0}}}};
    const struct orl_gonio_builder forest = {.rank = 4, .branches = branches, .count = BRANCHES};
    const struct orl_gonio_node root = {.branch = 1};
    size_t sizes[2];
    (void)state;
    for (uint32_t i = 0; i < FAN; i++)
        branches[0].child[i].branch = 2 + i;
    for (int k = 0; k < 2; k++) {
        char *text = NULL;
        FILE *out = open_memstream(&text, &sizes[k]);
        begin_count(k == 0 ? -1 : BRANCHES / 2);
        orl_gonio_builder_write(&forest, root, false, &flag, out);
        assert_int_equal(fclose(out), 0);
        free(text);
        assert_int_equal(polls, BRANCHES);
    }
    assert_true(sizes[1] < sizes[0] * 2 / 3);
}

/* ---- Readers --------------------------------------------------------------------------------- */

static int load_sensors(struct orl_files *provider, size_t *ret_count, struct orl_error *err)
{
    struct orl_sensor *sensors = NULL;
    const int code = orl_sensors_load(provider, "s.pts", &flag, &sensors, ret_count, err);
    free(sensors);
    return code;
}

static void test_sensors(void **state)
{
    enum { SENSORS = 40000 };
    char *text = NULL;
    size_t size = 0, count = 0;
    FILE *out = open_memstream(&text, &size);
    struct orl_error err;
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        fputs("0 0 0 0 0 1\n", out);
    assert_int_equal(fclose(out), 0);
    const char *const names[] = {"s.pts"};
    const struct orl_file contents[] = {{text, size, NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    struct orl_files provider = orl_files_from_memory(&memory);
    begin_count(-1);
    assert_int_equal(load_sensors(&provider, &count, &err), 0);
    assert_int_equal(count, SENSORS);
    assert_true(polls >= SENSORS / 5000);
    begin_count(polls / 2);
    assert_int_equal(load_sensors(&provider, &count, &err), ORL_ERR_CANCELLED);
    free(text);
}

static int read_none(void *ctx, const char *name, char **ret_text, struct orl_error *err)
{
    (void)ctx, (void)ret_text;
    return orl_error_set(err, ORL_ERR_NOT_FOUND, "'%s' is not there", name);
}

/* The text of a generator. */
static void test_generators(void **state)
{
    const char *const words[] = {"gensurf", "w", "s", "s*10", "t*10", "s*t", "80", "80"};
    const struct orl_generator_files none = {NULL, read_none};
    size_t whole = 0;
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct orl_text text = {.cancel = &flag};
        struct orl_error err;
        begin_count(k == 0 ? -1 : 1);
        assert_int_equal(orl_gensurf(words, 8, &none, &text, &err), 0);
        assert_int_equal(text.failed, k);
        if (k == 0) {
            whole = text.size;
            print_message("# gensurf: %zu bytes, %d polls\n", whole, polls);
            assert_true((size_t)polls >= whole / (2 * ORL_TEXT_POLL) && polls > 4);
        } else {
            assert_true(text.size < whole / 2);
        }
        orl_text_done(&text);
    }
}

/* ---- Sorting --------------------------------------------------------------------------------- */

struct item {
    uint32_t key, place;
};

static int compare_keys(const void *a, const void *b)
{
    const uint32_t one = ((const struct item *)a)->key, other = ((const struct item *)b)->key;
    return (one > other) - (one < other);
}

/* Sorting is stable, for any number of blocks. */
static void test_sorting(void **state)
{
    static const size_t counts[] = {0, 1, 1000, 16384, 16385, 40000, 100000, 131072};
    (void)state;
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        const size_t n = counts[c];
        struct item *items = malloc((n + 1) * sizeof *items);
        assert_non_null(items);
        for (int k = 0; k < 2; k++) {
            uint32_t random = 1;
            for (uint32_t i = 0; i < n; i++) {
                random = random * 1664525U + 1013904223U;
                items[i] = (struct item){random >> 18, i};
            }
            begin_count(k == 0 ? -1 : polls / 2);
            assert_int_equal(orl_sort(items, n, sizeof *items, compare_keys, &flag),
                             k == 0 ? 0 : ORL_ERR_CANCELLED);
            for (size_t i = 1; i < n && k == 0; i++)
                assert_true(
                    items[i - 1].key < items[i].key ||
                    (items[i - 1].key == items[i].key && items[i - 1].place < items[i].place));
            assert_true(polls >= (int)(n / 16384));
        }
        free(items);
    }
}

/* ---- Coincident surfaces --------------------------------------------------------------------- */

enum { SIDE = 200, TRIANGLES = SIDE * SIDE };

/* Lays adjacent triangles in one plane. */
static void lay_triangles(struct orl_parsed_scene *d)
{
    static struct orl_vec3 corners[TRIANGLES][3];
    static struct orl_material grey = {.kind = ORL_MATERIAL_PLASTIC};
    static char name[] = "t";
    *d = (struct orl_parsed_scene){.materials = &grey,
                                   .n_materials = 1,
                                   .surfaces = calloc(TRIANGLES, sizeof *d->surfaces),
                                   .n_surfaces = TRIANGLES,
                                   .cancel = &flag};
    assert_non_null(d->surfaces);
    for (int i = 0; i < TRIANGLES; i++) {
        const int row = i / SIDE;
        const double x = i % SIDE, y = row;
        corners[i][0] = orl_v3(x, y, 0);
        corners[i][1] = orl_v3(x + 0.9, y, 0);
        corners[i][2] = orl_v3(x, y + 0.9, 0);
        d->surfaces[i] = (struct orl_surface){.kind = ORL_SURFACE_POLYGON,
                                              .n_vertices = 3,
                                              .name = name,
                                              .file = name,
                                              .vertices = corners[i],
                                              .normal = orl_v3(0, 0, 1)};
    }
}

/* Polls in the search for duplicates, for planes, for what lies under the largest, and for pairs.
 */
static void test_places(void **state)
{
    enum { STEPS = 20 };
    struct orl_parsed_scene d;
    struct orl_error err;
    int all = 0;
    (void)state;
    for (int k = 0; k <= STEPS; k++) {
        lay_triangles(&d);
        const int at = k == 0 ? -1 : all * (k - 1) / STEPS;
        begin_count(at);
        assert_int_equal(orl_coincident_resolve(&d, &err), k == 0 ? 0 : ORL_ERR_CANCELLED);
        if (k == 0)
            all = polls;
        assert_true(k == 0 || polls <= at + 8); /* polls while it returns */
        free(d.surfaces);
        free(d.opposed);
    }
    print_message("# %d triangles in a plane: %d polls\n", TRIANGLES, all);
    assert_true(all >= 3 * TRIANGLES / 1024);
}

/* The checksum of a photon map. */
static void test_maps(void **state)
{
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_photon photon = {.flux = {1, 1, 1}};
    struct orl_thread_pool *pool = orl_thread_pool_new(1);
    struct orl_photon_map *map = NULL;
    struct orl_error err;
    (void)state;
    begin_count(-1);
    assert_int_equal(orl_photon_map_write(scratch_path("map"), &photon, 1, &build, pool, &err), 0);
    assert_int_equal(orl_photon_map_read(scratch_path("map"), &flag, &map, &err), 0);
    orl_photon_map_free(map);
    begin_count(0);
    assert_int_equal(orl_photon_map_read(scratch_path("map"), &flag, &map, &err),
                     ORL_ERR_CANCELLED);
    orl_thread_pool_free(pool);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_files, scratch_set_up, scratch_tear_down),
        cmocka_unit_test(test_reports),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_trees),
        cmocka_unit_test(test_sensors),
        cmocka_unit_test(test_generators),
        cmocka_unit_test(test_sorting),
        cmocka_unit_test(test_places),
        cmocka_unit_test_setup_teardown(test_maps, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
