/*
 * Maps of sensors: planes and cells of sensors on grids, rotated and not, and of scattered ones;
 * the outline of a room; the contents of the SVG; tables of a run.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "base/sampling/sampling.h"
#include "render/heat_map/heat_map.h"
#include "support/scene_text.h"
#include "support/scratch.h"

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

/* ---- Planes ---------------------------------------------------------------------------------- */

enum { ACROSS = 5, DOWN = 7, GRID = ACROSS * DOWN };

/* Fills in a grid of 0.5 by 0.4, rotated, at a height. */
static void fill_grid(struct orl_sensor *sensors, double turn, double z)
{
    for (int i = 0; i < GRID; i++) {
        const double a = 0.5 * (i % ACROSS), b = 0.4 * (double)(i / ACROSS);
        sensors[i] = (struct orl_sensor){
            orl_v3(1 + a * cos(turn) - b * sin(turn), 2 + a * sin(turn) + b * cos(turn), z),
            orl_v3(0, 0, 2)};
    }
}

static void test_grids(void **state)
{
    static const double turns[] = {0, 0.3, ORL_PI / 2};
    (void)state;
    for (int k = 0; k < 3; k++) {
        struct orl_sensor sensors[GRID + 3];
        struct orl_sensor_plane planes[4];
        size_t count;
        fill_grid(sensors, turns[k], 0.76);
        for (int i = 0; i < 3; i++)
            sensors[GRID + i] = (struct orl_sensor){orl_v3(i, 1, 2), orl_v3(1, 0, 0)};
        assert_int_equal(orl_sensor_planes_find(sensors, GRID + 3, 4, planes, &count), 0);
        assert_int_equal(count, 1);
        assert_int_equal(planes[0].count, GRID);
        assert_true(planes[0].grid);
        assert_near(planes[0].offset, 0.76, 1e-12);
        assert_near(planes[0].cell[0] * planes[0].cell[1], 0.5 * 0.4, 1e-9);
        const double along = fabs(cos(planes[0].angle - turns[k]));
        assert_true(along > 1 - 1e-9 || along < 1e-9);
        assert_near(planes[0].cell[0], along > 0.5 ? 0.5 : 0.4, 1e-9);
        orl_sensor_planes_done(planes, count);
    }
}

/* Two floors and a wall: the larger first, the wall's axes horizontal and vertical. */
static void test_planes(void **state)
{
    struct orl_sensor sensors[2 * GRID + 6];
    struct orl_sensor_plane planes[2];
    size_t count;
    (void)state;
    fill_grid(sensors, 0, 0);
    fill_grid(sensors + GRID, 0, 3);
    for (int i = 0; i < 6; i++) {
        sensors[2 * GRID + i] =
            (struct orl_sensor){orl_v3(0, i % 3, 1 + (double)(i / 3)), orl_v3(1, 0, 0)};
    }
    sensors[3].direction = orl_v3(0, 0, -1);
    assert_int_equal(orl_sensor_planes_find(sensors, 2 * GRID + 6, 2, planes, &count), 0);
    assert_int_equal(count, 2);
    assert_int_equal(planes[0].count, GRID);
    assert_near(planes[0].offset, 3, 0);
    assert_int_equal(planes[1].count, GRID - 1);
    assert_true(planes[1].grid);
    orl_sensor_planes_done(planes, count);
    assert_int_equal(orl_sensor_planes_find(sensors + 2 * GRID, 6, 2, planes, &count), 0);
    assert_int_equal(count, 1);
    assert_near(planes[0].v.z, 1, 1e-12);
    assert_near(planes[0].u.y, 1, 1e-12);
    orl_sensor_planes_done(planes, count);
}

/* Sensors in a row of any direction get squares as wide as their spacing, not slivers. */
static void test_rows(void **state)
{
    static const double turns[] = {0, 0.3, ORL_PI / 2, 2.8};
    enum { ROW = 5 };
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct orl_sensor sensors[ROW];
        struct orl_sensor_plane planes[1];
        size_t count;
        const double c = cos(turns[k]), s = sin(turns[k]);
        for (int i = 0; i < ROW; i++)
            sensors[i] =
                (struct orl_sensor){orl_v3(1 + 0.6 * i * c, 2 + 0.6 * i * s, 1), orl_v3(0, 0, 1)};
        assert_int_equal(orl_sensor_planes_find(sensors, ROW, 1, planes, &count), 0);
        assert_int_equal(count, 1);
        assert_near(planes[0].cell[0], 0.6, 1e-9);
        assert_near(planes[0].cell[1], 0.6, 1e-9);
        assert_near(planes[0].high[0] - planes[0].low[0],
                    0.6 * (ROW - 1) * fabs(c) + 0.6 * (fabs(c) + fabs(s)), 1e-9);
        orl_sensor_planes_done(planes, count);
    }
}

/* Scattered sensors share the plane's area in squares. */
static void test_scattered(void **state)
{
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 0);
    struct orl_sensor sensors[200];
    struct orl_sensor_plane planes[1];
    size_t count;
    (void)state;
    for (int i = 0; i < 200; i++)
        sensors[i] = (struct orl_sensor){
            orl_v3(10 * orl_random_uniform(&random), 5 * orl_random_uniform(&random), 1),
            orl_v3(0, 0, 1)};
    assert_int_equal(orl_sensor_planes_find(sensors, 200, 1, planes, &count), 0);
    assert_int_equal(count, 1);
    assert_false(planes[0].grid);
    assert_near(planes[0].cell[0], sqrt(10 * 5 / 200.0), 0.02);
    orl_sensor_planes_done(planes, count);
    /* Too few sensors, or all in one place, give no map and no error. */
    assert_int_equal(orl_sensor_planes_find(sensors, 3, 1, planes, &count), 0);
    assert_int_equal(count, 0);
    for (int i = 0; i < 10; i++)
        sensors[i] = sensors[0];
    assert_int_equal(orl_sensor_planes_find(sensors, 10, 1, planes, &count), 0);
    assert_int_equal(count, 0);
}

/* ---- Section --------------------------------------------------------------------------------- */

/* A room of 4 by 3 with a round column of radius 0.5, and a sphere above the section. */
static const char room[] = "void plastic gray 0 0 5 .5 .5 .5 0 0\n"
                           "gray polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0\n"
                           "gray polygon south 0 0 12 0 0 0 0 0 2 4 0 2 4 0 0\n"
                           "gray polygon north 0 0 12 0 3 0 4 3 0 4 3 2 0 3 2\n"
                           "gray polygon west 0 0 12 0 0 0 0 3 0 0 3 2 0 0 2\n"
                           "gray polygon east 0 0 12 4 0 0 4 0 2 4 3 2 4 3 0\n"
                           "gray cylinder column 0 0 7 2 1.5 0 2 1.5 2 .5\n"
                           "gray sphere lamp 0 0 4 1 1 1.8 .1\n"
                           "void glow sky_glow 0 0 4 10 10 10 0\n"
                           "sky_glow source sky 0 0 4 0 0 1 180\n";

struct lengths {
    double straight, round; /* length of pieces along the axes, and of others */
};

static void add_piece(void *ctx, const double from[2], const double to[2])
{
    struct lengths *lengths = ctx;
    const double du = to[0] - from[0], dv = to[1] - from[1];
    if (fabs(fabs(from[0] - 2) - 2) < 1e-6 || fabs(fabs(from[1] - 1.5) - 1.5) < 1e-6)
        lengths->straight += hypot(du, dv);
    else
        lengths->round += hypot(du, dv);
}

static struct orl_sensor_plane level(double z)
{
    return (struct orl_sensor_plane){
        .normal = orl_v3(0, 0, 1), .u = orl_v3(1, 0, 0), .v = orl_v3(0, 1, 0), .offset = z};
}

static void test_section(void **state)
{
    (void)state;
    struct orl_geometry *geometry = scene_geometry(room);
    const double heights[] = {0, 1, 1.8};
    for (int i = 0; i < 3; i++) {
        struct lengths lengths = {0, 0};
        const struct orl_sensor_plane plane = level(heights[i]);
        orl_section_cut(geometry, &plane, add_piece, &lengths);
        assert_near(lengths.straight, 14, 1e-6);
        const double circle = 2 * 32 * sin(ORL_PI / 32);
        assert_near(lengths.round, circle * (0.5 + (i == 2 ? 0.1 : 0)), 1e-3);
    }
    orl_geometry_free(geometry);
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static int count_of(const char *text, const char *what)
{
    int n = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at++)
        n++;
    return n;
}

/* Only the cell whose interval contains the threshold is hatched; all cells have numbers. */
static void test_map(void **state)
{
    (void)state;
    struct orl_geometry *geometry = scene_geometry(room);
    struct orl_sensor sensors[4];
    struct orl_sensor_plane planes[1];
    const double lux[4] = {100, 290, 400, 1234.5};
    const double intervals[4][2] = {{90, 110}, {270, 310}, {390, 410}, {1200, 1300}};
    struct orl_heat_map_request how = {.thresholds_lx = {300}, .n_thresholds = 1};
    size_t count, size;
    for (int i = 0; i < 4; i++)
        sensors[i] =
            (struct orl_sensor){orl_v3(1 + i % 2, 1 + (double)(i / 2), 1), orl_v3(0, 0, 1)};
    assert_int_equal(orl_sensor_planes_find(sensors, 4, 1, planes, &count), 0);
    const struct orl_heat_map map = {geometry, planes, "Illuminance", "lx", lux, intervals, &how};
    assert_int_equal(orl_heat_map_write(&map, ORL_CANVAS_SVG, scratch_path("a.svg"), NULL), 0);
    char *with = (char *)scene_read_bytes(scratch_path("a.svg"), &size);
    assert_non_null(strstr(with, ">1234</text>"));
    assert_non_null(strstr(with, ">290</text>"));
    assert_non_null(strstr(with, "4 sensors at z = 1 m"));
    assert_non_null(strstr(with, "1 hatched: 300 lx"));
    how.thresholds_lx[0] = 350;
    assert_int_equal(orl_heat_map_write(&map, ORL_CANVAS_SVG, scratch_path("a.svg"), NULL), 0);
    char *without = (char *)scene_read_bytes(scratch_path("a.svg"), &size);
    assert_null(strstr(without, "hatched"));
    assert_true(count_of(with, "<path") > count_of(without, "<path") + 10);
    const double sunny[4] = {950, 1200, 2000, 21000};
    const struct orl_heat_map by_values = {geometry, planes,    "Illuminance",        "lx",
                                           sunny,    intervals, &orl_default_heat_map};
    assert_int_equal(orl_heat_map_write(&by_values, ORL_CANVAS_SVG, scratch_path("b.svg"), NULL),
                     0);
    char *logarithmic = (char *)scene_read_bytes(scratch_path("b.svg"), &size);
    assert_non_null(strstr(logarithmic, ">50000</text>"));
    assert_non_null(strstr(logarithmic, ">500</text>"));
    assert_null(strstr(logarithmic, ">25000</text>"));
    free(logarithmic);
    assert_int_equal(strcmp(with + strlen(with) - 7, "</svg>\n"), 0);
    assert_int_equal(orl_heat_map_write(&map, ORL_CANVAS_PNG, scratch_path("a.png"), NULL), 0);
    struct orl_error err;
    assert_int_equal(orl_heat_map_write(&map, ORL_CANVAS_PNG, scratch_path("no/a.png"), &err),
                     ORL_ERR_IO);
    assert_int_equal(orl_heat_map_write(&map, ORL_CANVAS_SVG, scratch_path("no/a.svg"), &err),
                     ORL_ERR_IO);
    free(with);
    free(without);
    orl_sensor_planes_done(planes, count);
    orl_geometry_free(geometry);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grids),   cmocka_unit_test(test_planes),
        cmocka_unit_test(test_rows),    cmocka_unit_test(test_scattered),
        cmocka_unit_test(test_section), cmocka_unit_test(test_map),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
