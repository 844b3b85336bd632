/* Peaks of BSDFs, and their pictures. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf_polar.h>
#include <oriel/job/picture.h>

#include "chart/charts.h"
#include "fixtures/bsdf_ask.h"
#include "support/cli.h"
#include "support/panels.h"

static struct orl_bsdf *load_bsdf(const char *text, enum orl_bsdf_basis basis)
{
    static const double cell[4] = {0, 1, 0, 1};
    const struct panel panel = {
        .text = text, .basis = basis, .cell = cell, .resolution = 32, .paths = 256};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    orl_bsdf_make_result_done(&made);
    return bsdf;
}

static const char slab[] = "void dielectric d 0 0 5 1 1 1 1.5 0\n"
                           "!genbox d slab 4 4 .5 | xform -t -2 -2 -.5\n";
static const char sheet[] = "void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                            "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n";

/* All light goes straight or is mirrored, to within a cell. The 32 by 32 cells are at most 4.5
 * degrees across at 48 degrees, so a cell's middle is at most 2.3 degrees from any place in it. */
static void a_slab_has_two_peaks(void **state)
{
    struct orl_bsdf *bsdf = load_bsdf(slab, ORL_BSDF_TENSOR_TREE_4);
    struct orl_bsdf_polar *polar = malloc(sizeof *polar);
    struct orl_bsdf_lobe peaks[ORL_BSDF_PEAKS];
    double r, t;
    (void)state;
    slab_shares(cos(48 * ORL_DEG_TO_RAD), 1.5, 1, &r, &t);
    for (int front = 0; front < 2; front++) {
        orl_bsdf_polar(bsdf, front, 48, 70, polar);
        for (int k = 0; k < 2; k++) {
            const size_t n = orl_bsdf_find_peaks(bsdf, front, 48, 70, polar, k, peaks);
            assert_int_equal(n, 1);
            assert_close(peaks[0].theta_deg, 48, 2.3);
            assert_close(peaks[0].phi_deg, 250, 2.3 / sin(48 * ORL_DEG_TO_RAD));
            assert_true(peaks[0].share > 0.6 * (k ? t : r) && peaks[0].share < 1.05 * (k ? t : r));
            assert_true(peaks[0].f > 10 * (k ? t : r));
        }
    }
    free(polar);
    orl_bsdf_unref(bsdf);
}

static void an_even_sheet_has_none(void **state)
{
    struct orl_bsdf *bsdf = load_bsdf(sheet, ORL_BSDF_TENSOR_TREE_4);
    struct orl_bsdf_polar *polar = malloc(sizeof *polar);
    struct orl_bsdf_lobe peaks[ORL_BSDF_PEAKS];
    (void)state;
    orl_bsdf_polar(bsdf, true, 30, 10, polar);
    for (int k = 0; k < 2; k++)
        assert_int_equal(orl_bsdf_find_peaks(bsdf, true, 30, 10, polar, k, peaks), 0);
    free(polar);
    orl_bsdf_unref(bsdf);
}

/* A cell of a matrix is one peak, for any width. */
static void a_plateau_is_one_peak(void **state)
{
    struct orl_bsdf *bsdf = load_bsdf(slab, ORL_BSDF_KLEMS_FULL);
    struct orl_bsdf_polar *polar = malloc(sizeof *polar);
    struct orl_bsdf_lobe peaks[ORL_BSDF_PEAKS];
    (void)state;
    orl_bsdf_polar(bsdf, false, 40, 0, polar);
    assert_int_equal(orl_bsdf_find_peaks(bsdf, false, 40, 0, polar, true, peaks), 1);
    assert_close(peaks[0].theta_deg, 40, 5);
    assert_close(peaks[0].phi_deg, 180, 7.5);
    free(polar);
    orl_bsdf_unref(bsdf);
}

/* ---- Pictures -------------------------------------------------------------------------------- */

struct desk {
    struct orl_bsdf *bsdfs[2];
    struct orl_bsdf_check checks[2];
    struct orl_bsdf_chart chart;
    char folder[64];
};

static int set_up(void **state)
{
    struct desk *d = calloc(1, sizeof *d);
    d->bsdfs[0] = load_bsdf(slab, ORL_BSDF_TENSOR_TREE_4);
    d->bsdfs[1] = load_bsdf(sheet, ORL_BSDF_KLEMS_QUARTER);
    d->chart = (struct orl_bsdf_chart){.n_files = 2, .theta_deg = 48, .phi_deg = 70};
    for (int i = 0; i < 2; i++) {
        orl_bsdf_examine(d->bsdfs[i], &d->checks[i]);
        d->chart.files[i] =
            (struct orl_bsdf_chart_file){i ? "sheet.xml" : "slab.xml", d->bsdfs[i], &d->checks[i]};
    }
    cli_make_folder(d->folder);
    *state = d;
    return 0;
}

static int tear_down(void **state)
{
    struct desk *d = *state;
    cli_remove_folder(d->folder);
    orl_bsdf_unref(d->bsdfs[0]);
    orl_bsdf_unref(d->bsdfs[1]);
    free(d);
    return 0;
}

static void draw_chart(const struct orl_bsdf_chart *chart, enum orl_canvas_kind kind,
                       const char *path)
{
    struct orl_error err = {0};
    if (orl_bsdf_chart_write(chart, kind, path, &err) < 0)
        fail_msg("%s", err.message);
}

static void pictures_say_what_they_show(void **state)
{
    static const char *const said[] = {
        "slab.xml",           "sheet.xml", "1/sr", "theta 48, phi 70", "The second minus the first",
        "Energy is conserved"};
    struct desk *d = *state;
    char path[96];
    snprintf(path, sizeof path, "%s/two.svg", d->folder);
    draw_chart(&d->chart, ORL_CANVAS_SVG, path);
    char *text = cli_read_file(d->folder, "two.svg");
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        if (!strstr(text, said[i]))
            fail_msg("nothing says \"%s\"", said[i]);
    free(text);
}

static void frames_are_of_one_size(void **state)
{
    struct desk *d = *state;
    char pngs[2][96], all[96];
    const char *const frames[2] = {pngs[0], pngs[1]};
    struct orl_error err = {0};
    snprintf(all, sizeof all, "%s/all.png", d->folder);
    for (int i = 0; i < 2; i++) {
        snprintf(pngs[i], sizeof pngs[i], "%s/%d.png", d->folder, i);
        d->chart.theta_deg = 40.0 * i;
        draw_chart(&d->chart, ORL_CANVAS_PNG, pngs[i]);
    }
    assert_int_equal(orl_animation_write(frames, 2, 0.5, all, &err), 0);
    d->chart.n_files = 1;
    draw_chart(&d->chart, ORL_CANVAS_PNG, pngs[1]);
    assert_int_equal(orl_animation_write(frames, 2, 0.5, all, &err), ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "another size"));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slab_has_two_peaks),
        cmocka_unit_test(an_even_sheet_has_none),
        cmocka_unit_test(a_plateau_is_one_peak),
        cmocka_unit_test_setup_teardown(pictures_say_what_they_show, set_up, tear_down),
        cmocka_unit_test_setup_teardown(frames_are_of_one_size, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
