/*
 * Matrices of the three- and five-phase methods: the year computed with them equals the year by
 * paths, to the resolution of Klems cells; parts compared with quadrature; and scenes without
 * matrices.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_phases.h>
#include <oriel/base/vec.h>

#include "annual/matrices/imported_matrices.h"
#include "bsdf/matrix/matrix.h"
#include "fixtures/bsdf_make.h"
#include "support/cli.h"
#include "support/room.h"

enum { ROWS = 3, SENSORS = 4, CELLS = ORL_PHASES_CELLS, PATCHES = ORL_ANNUAL_PATCHES };

#define DOCUMENT(scene, more)                                                                      \
    "{\"kind\": \"annual\", \"scene\": {\"files\": [\"" scene                                      \
    "\"]}, \"weather\": \"w.wea\", \"samples\": 4096, \"metrics\": [\"illuminance\"], \"grids\": " \
    "[{\"name\": \"desks\", \"sensors\": [[2, 1, 0.8, 0, 0, 1], [2, 3, 0.8, 0, 0, 1], "            \
    "[2, 2, 1.75, 0, -1, 0], [1, 4, 1.2, 1, 0, 0]]}], \"seed\": 4" more "}\n"
#define BY_MATRICES(more)                                                                          \
    DOCUMENT("panel.rad", ", \"formats\": [\"ill\"], \"matrices\": [{\"grid\": \"desks\", "        \
                          "\"sky\": \"s.smx\", " more "}]")

static const char weather[] = "place made_up\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                              "site_elevation 0\nweather_data_file_units 1\n"
                              "3 22 9.5 0 100\n3 22 12.5 0 200\n6 21 12.5 0 300\n";

/* ---- Files ----------------------------------------------------------------------------------- */

/* Returns a pane that transmits 0.6 into the cell of incidence, and scatters 0.1. */
static char *make_pane(void)
{
    struct orl_basis basis;
    struct text data;
    assert_int_equal(orl_basis_standard("LBNL/Klems Full", &basis), 0);
    text_open(&data);
    for (int in = 0; in < CELLS; in++)
        for (int out = 0; out < CELLS; out++)
            fprintf(data.stream, "%.9g,\n",
                    0.1 / ORL_PI + (in == out ? 0.6 / orl_basis_ring(&basis, in)->omega_sr : 0));
    text_close(&data);
    struct text xml = make_file("Columns", "Transmission Front", "LBNL/Klems Full", data.data);
    free(data.data);
    return xml.data;
}

/* Radiance of three skies: uniform, brighter with each row, and bright in one quarter. */
static double radiance(size_t patch, int sky)
{
    if (patch == 0)
        return 0.3;
    return sky == 0 ? 1 : sky == 1 ? 1 + (double)patch / 1000 : (patch % 120 < 30 ? 3 : 0.5);
}

static void write_sky(const char *folder)
{
    struct text t;
    text_open(&t);
    fprintf(t.stream, "#?RADIANCE\nNROWS=%d\nNCOLS=%d\nNCOMP=3\nFORMAT=ascii\n\n", PATCHES, ROWS);
    for (size_t p = 0; p < PATCHES; p++)
        for (int sky = 0; sky < ROWS; sky++)
            for (int k = 0; k < 3; k++)
                fprintf(t.stream, "%.6g\n", radiance(p, sky));
    text_close(&t);
    cli_write_file(folder, "s.smx", t.data);
    free(t.data);
}

static int set_up(void **state)
{
    static char folder[64];
    char *pane = make_pane();
    cli_make_folder(folder);
    cli_write_file(folder, "pane.xml", pane);
    cli_write_file(folder, "w.wea", weather);
    cli_write_file(folder, "panel.rad", ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE ROOM_GROUND);
    cli_write_file(folder, "clear.rad", ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND);
    cli_write_file(folder, "open.rad",
                   ROOM_GREY "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n" ROOM_GROUND);
    write_sky(folder);
    free(pane);
    *state = folder;
    return 0;
}

static int tear_down(void **state)
{
    cli_remove_folder(*state);
    return 0;
}

/* Runs a document of the folder; the output goes to a subfolder. */
static int run_document(const char *folder, const char *text, const char *output,
                        const char *threads, struct cli_result *ret_result)
{
    char document[96], to[96];
    cli_write_file(folder, "year.json", text);
    snprintf(document, sizeof document, "%s/year.json", folder);
    snprintf(to, sizeof to, "%s/%s", folder, output);
    const char *const args[] = {"annual", document, "-o", to, "--threads", threads, NULL};
    cli_run(args, ret_result);
    return ret_result->exit_code;
}

static void need(const char *folder, const char *text, const char *output, const char *threads)
{
    static struct cli_result result;
    if (run_document(folder, text, output, threads, &result) != 0)
        fail_msg("%s", result.err);
}

static struct orl_rgb_matrix read(const char *folder, const char *name)
{
    struct orl_rgb_matrix matrix;
    struct orl_error err = {0};
    char path[192];
    struct text t;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("there is no %s", path);
    text_open(&t);
    for (int c; (c = fgetc(file)) != EOF;)
        fputc(c, t.stream);
    fclose(file);
    text_close(&t);
    if (orl_rgb_matrix_read(name, t.data, t.size, &matrix, &err) < 0)
        fail_msg("%s: %s", name, err.message);
    free(t.data);
    return matrix;
}

static double at(const struct orl_rgb_matrix *matrix, size_t row, size_t column)
{
    return (double)matrix->values[3 * (row * matrix->columns + column)];
}

/* ---- The year by matrices -------------------------------------------------------------------- */

/* Paths on both sides have an error of 1 % of a value; the mean must be right to 0.5 %. */
static void test_the_same_year(void **state)
{
    const char *folder = *state;
    need(folder, DOCUMENT("panel.rad", ", \"formats\": [\"phases\", \"coefficients\"]"), "made",
         "1");
    need(folder,
         BY_MATRICES("\"view\": \"made/desks.p.v.mtx\", \"transmission\": \"made/p.t.mtx\", "
                     "\"daylight\": \"made/p.d.mtx\""),
         "phases", "1");
    need(folder,
         BY_MATRICES("\"view\": \"made/desks.p.v.mtx\", \"transmission\": \"pane.xml\", "
                     "\"daylight\": \"made/p.d.mtx\""),
         "xml", "1");
    need(folder, BY_MATRICES("\"coefficients\": \"made/desks.dc.mtx\""), "paths", "1");
    struct orl_rgb_matrix by_phases = read(folder, "phases/desks.ill"),
                          by_xml = read(folder, "xml/desks.ill"),
                          by_paths = read(folder, "paths/desks.ill");
    double squares = 0, sum = 0, real = 0;
    assert_int_equal(by_paths.rows, SENSORS);
    assert_int_equal(by_paths.columns, ROWS);
    for (size_t i = 0; i < SENSORS; i++)
        for (size_t c = 0; c < ROWS; c++) {
            const double a = at(&by_phases, i, c), b = at(&by_paths, i, c);
            print_message("sensor %zu, sky %zu: %.2f by phases, %.2f by paths\n", i, c, a, b);
            assert_true(b > 0);
            assert_true(fabs(at(&by_xml, i, c) - a) <= 1e-5 * a);
            squares += (a / b - 1) * (a / b - 1) / (SENSORS * ROWS);
            sum += a;
            real += b;
        }
    print_message("rms %.4f, of the sum %+.4f\n", sqrt(squares), sum / real - 1);
    assert_true(sqrt(squares) <= 0.015);
    assert_true(fabs(sum / real - 1) <= 0.0075);
    orl_rgb_matrix_done(&by_phases);
    orl_rgb_matrix_done(&by_xml);
    orl_rgb_matrix_done(&by_paths);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Returns the direct light at a sensor that faces the pane, for a radiance of 1: by quadrature. */
static double straight_light(void)
{
    enum { N = 400 };
    double sum = 0;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            const double x = 1 + 2 * (i + 0.5) / N - 2, z = 1 + 1.5 * (k + 0.5) / N - 1.75;
            const double square = x * x + z * z + 4;
            sum += 4 / (square * square) * (2.0 / N) * (1.5 / N);
        }
    return sum;
}

static void test_parts(void **state)
{
    const char *folder = *state;
    need(folder, DOCUMENT("clear.rad", ", \"formats\": [\"phases\"]"), "clear", "1");
    struct orl_rgb_matrix view = read(folder, "clear/desks.p.v.mtx"),
                          straight = read(folder, "clear/desks.p.vd.mtx"),
                          transmission = read(folder, "clear/p.t.mtx"),
                          daylight = read(folder, "clear/p.d.mtx"),
                          bare = read(folder, "clear/p.dd.mtx"),
                          suns = read(folder, "clear/desks.cds.mtx");
    double seen = 0;
    assert_int_equal(view.columns, CELLS);
    assert_int_equal(daylight.columns, PATCHES);
    assert_int_equal(suns.columns, ORL_PHASES_SUNS);
    for (size_t c = 0; c < CELLS; c++) {
        seen += at(&straight, 2, c);
        assert_true(at(&straight, 2, c) <= at(&view, 2, c));
        /* Clear glass keeps the direction. */
        for (size_t in = 0; in < CELLS; in++)
            assert_true(in == c || at(&transmission, c, in) < 1e-6);
    }
    assert_true(fabs(seen / straight_light() - 1) <= 0.01);
    /* Up, the whole light is the sky's; down, it is a fifth of the light incident on the ground,
     * from which the building hides some of the sky. */
    double above = 0, below = 0, bare_below = 0;
    for (size_t p = 0; p < PATCHES; p++) {
        above += at(&daylight, CELLS - 1 - 3, p);
        below += at(&daylight, CELLS - 1 - 9, p);
        bare_below += at(&bare, CELLS - 1 - 9, p);
    }
    assert_true(fabs(above - 1) <= 1e-4);
    assert_true(below > 0.1 && below < 0.2 && bare_below == 0);
    /* A sun a degree above the southern horizon: Fresnel at normal incidence, n = 1.52. */
    const double r = (0.52 / 2.52) * (0.52 / 2.52);
    const double passes = (1 - r) * (1 - r) * 0.9 / (1 - r * r * 0.81);
    const double solid_sr = 2 * ORL_PI * (1 - cos(0.5 * ORL_SUN_DIAMETER_DEG * ORL_PI / 180));
    assert_true(fabs(at(&suns, 2, 1 + 90) / (passes * solid_sr) - 1) <= 0.005);
    assert_true(at(&suns, 2, 1) == 0 && at(&suns, 2, 0) == 0);
    assert_true(fabs(at(&transmission, 0, 0) / passes - 1) <= 0.005);
    orl_rgb_matrix_done(&view);
    orl_rgb_matrix_done(&straight);
    orl_rgb_matrix_done(&transmission);
    orl_rgb_matrix_done(&daylight);
    orl_rgb_matrix_done(&bare);
    orl_rgb_matrix_done(&suns);
}

/* ---- Bytes, and refusals --------------------------------------------------------------------- */

static void test_any_pool_size(void **state)
{
    static const char *const names[] = {"desks.p.v.mtx", "p.d.mtx", "p.t.mtx", "desks.cds.mtx"};
    const char *folder = *state;
    need(folder, DOCUMENT("clear.rad", ", \"formats\": [\"phases\"]"), "three", "3");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char one[64], three[64];
        snprintf(one, sizeof one, "clear/%s", names[i]);
        snprintf(three, sizeof three, "three/%s", names[i]);
        struct orl_rgb_matrix a = read(folder, one), b = read(folder, three);
        assert_memory_equal(a.values, b.values, 3 * a.rows * a.columns * sizeof *a.values);
        orl_rgb_matrix_done(&a);
        orl_rgb_matrix_done(&b);
    }
}

static void test_refused(void **state)
{
    static struct cli_result result;
    const char *folder = *state;
    assert_int_not_equal(run_document(folder, DOCUMENT("open.rad", ", \"formats\": [\"phases\"]"),
                                      "no", "1", &result),
                         0);
    assert_non_null(strstr(result.err, "light enters other than through windows"));
    assert_int_not_equal(
        run_document(folder,
                     DOCUMENT("clear.rad",
                              ", \"formats\": [\"phases\"], \"accuracy\": {\"verdict\": "
                              "\"sDA300/50 >= 55 %\"}"),
                     "no", "1", &result),
        0);
    assert_non_null(strstr(result.err, "phase matrices need a single run"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_same_year), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_any_pool_size), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
