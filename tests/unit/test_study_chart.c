/* Charts: ticks, the layout of texts, and files that other programs can read. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <expat.h>
#include <png.h>

#include "chart/charts.h"
#include "chart/study_layout.h"
#include "study/study_errors.h"
#include "support/cli.h"
#include "support/scene_text.h"
#include "support/study_data.h"

/* Returns true if the tick is 1, 2 or 5 times a power of ten. */
static bool is_round(double tick)
{
    const double digits = tick / pow(10, floor(log10(tick) + 1e-9));
    return fabs(digits - 1) < 1e-9 || fabs(digits - 2) < 1e-9 || fabs(digits - 5) < 1e-9;
}

static void test_ticks_are_round_and_apart(void **state)
{
    (void)state;
    for (double low = 1e-6; low < 1e6; low *= 3.7) {
        for (double ratio = 1; ratio < 1e9; ratio = 5.3 * ratio) {
            struct orl_axis axis;
            orl_axis_init(&axis, low, low * ratio, 600, 100, 22);
            assert_in_range(axis.n_ticks, 2, ORL_AXIS_TICKS);
            assert_true(orl_axis_at(&axis, low) < 600 && orl_axis_at(&axis, low * ratio) > 100);
            for (size_t i = 0; i < axis.n_ticks; i++) {
                const double at = orl_axis_at(&axis, axis.ticks[i]);
                assert_true(is_round(axis.ticks[i]));
                assert_true(at <= 600.001 && at >= 99.999);
                assert_true(i == 0 || orl_axis_at(&axis, axis.ticks[i - 1]) - at >= 22);
            }
        }
    }
}

static void test_ticks_are_written_plainly(void **state)
{
    static const struct {
        double tick;
        const char *text;
    } cases[] = {{0.05, "0.05"}, {0.1, "0.1"},     {1, "1"},
                 {200, "200"},   {50000, "50000"}, {2e6, "2e+06"}};
    char text[32];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        orl_axis_format(cases[i].tick, text, sizeof text);
        assert_string_equal(text, cases[i].text);
    }
}

static void assert_laid_out(const struct orl_chart *chart)
{
    const struct orl_chart_box page = {0, 0, chart->width, chart->height};
    for (size_t i = 0; i < chart->n_texts; i++) {
        const struct orl_chart_box *a = &chart->texts[i].box;
        if (a->x0 < page.x0 || a->y0 < page.y0 || a->x1 > page.x1 || a->y1 > page.y1)
            fail_msg("\"%s\" leaves the page", chart->texts[i].text);
        for (size_t k = 0; k < i; k++)
            if (orl_box_overlaps(a, &chart->texts[k].box))
                fail_msg("\"%s\" meets \"%s\"", chart->texts[i].text, chart->texts[k].text);
    }
}

/* The points crowd in a corner of the plot: 25 of them in a fifth of each axis. */
static void test_no_two_texts_meet(void **state)
{
    (void)state;
    for (uint64_t index = 0; index < 40; index++) {
        struct orl_study study = study_of_chance(index, index % 13, index % 26);
        struct orl_chart chart;
        size_t labels = 0;
        assert_int_equal(orl_chart_make(&study, "A title", &chart, NULL), 0);
        assert_laid_out(&chart);
        for (size_t i = 0; i < chart.n_texts; i++)
            labels += chart.texts[i].role == ORL_CHART_GIVEN;
        /* All labels have been placed. */
        assert_int_equal(chart.n_unlabelled, 0);
        assert_int_equal(labels, study.n_external);
        orl_chart_done(&chart);
        orl_study_done(&study);
    }
}

static void test_long_titles_and_names_are_cut(void **state)
{
    char title[400];
    struct orl_study study = study_of_chance(1, 6, 2);
    struct orl_chart chart;
    (void)state;
    memset(title, 'W', sizeof title - 1);
    title[sizeof title - 1] = '\0';
    free(study.external[0].name);
    study.external[0].name = strdup(title);
    assert_int_equal(orl_chart_make(&study, title, &chart, NULL), 0);
    assert_laid_out(&chart);
    orl_chart_done(&chart);
    orl_study_done(&study);
}

/* The largest range that can be shown, and points that cannot be: without error, time or a finite
 * value. */
static void test_absurd_points_do_no_harm(void **state)
{
    struct orl_study study = study_of_chance(5, 6, 2);
    struct orl_chart chart;
    (void)state;
    study.points[0].rms = NAN;
    study.points[1].rms = 0;
    study.points[2].rms = 1e300;
    study.points[3].total_s = INFINITY;
    study.points[4].rms_error = INFINITY;
    study.external[0].here_s = study.external[1].rms = 1e12;
    study.external[1].here_s = study.external[0].rms = 1e-12;
    orl_study_mark_front(study.points, study.n_points);
    assert_int_equal(orl_chart_make(&study, NULL, &chart, NULL), 0);
    assert_laid_out(&chart);
    orl_chart_done(&chart);
    study.n_points = study.n_external = 0;
    assert_int_equal(orl_chart_make(&study, NULL, &chart, NULL), 0);
    assert_laid_out(&chart);
    orl_chart_done(&chart);
    study.n_external = 2;
    orl_study_done(&study);
}

static void test_svg_is_well_formed(void **state)
{
    struct orl_study study = study_of_chance(3, 6, 5);
    char folder[64], path[128];
    size_t size;
    (void)state;
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/study.svg", folder);
    assert_int_equal(orl_study_chart_write(&study, "Fish & chips <1 %", ORL_CANVAS_SVG, path, NULL),
                     0);
    unsigned char *bytes = scene_read_bytes(path, &size);
    XML_Parser parser = XML_ParserCreate(NULL);
    assert_non_null(parser);
    if (XML_Parse(parser, (const char *)bytes, (int)size, 1) != XML_STATUS_OK)
        fail_msg("line %lu: %s", XML_GetCurrentLineNumber(parser),
                 XML_ErrorString(XML_GetErrorCode(parser)));
    XML_ParserFree(parser);
    free(bytes);
    cli_remove_folder(folder);
    orl_study_done(&study);
}

/* The picture has the requested size, is mostly white, and has ink at the first curve's marker. */
static void test_png_shows_the_points(void **state)
{
    struct orl_study study = study_of_chance(4, 6, 5);
    char folder[64], path[128];
    png_image image = {.version = PNG_IMAGE_VERSION};
    struct orl_chart chart;
    size_t white = 0;
    (void)state;
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/study.png", folder);
    assert_int_equal(orl_study_chart_write(&study, NULL, ORL_CANVAS_PNG, path, NULL), 0);
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_int_equal(image.width, 2 * ORL_CHART_WIDTH);
    assert_int_equal(image.height, 2 * ORL_CHART_HEIGHT);
    image.format = PNG_FORMAT_GRAY;
    unsigned char *pixels = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(pixels);
    assert_true(png_image_finish_read(&image, NULL, pixels, 0, NULL));
    for (size_t i = 0; i < (size_t)image.width * image.height; i++)
        white += pixels[i] > 250;
    assert_true(white > (size_t)image.width * image.height * 3 / 4);
    assert_int_equal(orl_chart_make(&study, NULL, &chart, NULL), 0);
    for (size_t i = 0; i < study.n_external; i++) {
        const size_t x = (size_t)(2 * orl_axis_at(&chart.x, study.external[i].here_s));
        const size_t y = (size_t)(2 * orl_axis_at(&chart.y, 100 * study.external[i].rms));
        assert_true(pixels[y * image.width + x] < 200);
    }
    orl_chart_done(&chart);
    free(pixels);
    cli_remove_folder(folder);
    orl_study_done(&study);
}

/* A folder that does not exist gives an error, and no file. */
static void test_files_that_cannot_be_written(void **state)
{
    struct orl_study study = study_of_chance(2, 2, 0);
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(
        orl_study_chart_write(&study, NULL, ORL_CANVAS_SVG, "/nowhere/at/all.svg", &err),
        ORL_ERR_IO);
    assert_int_equal(
        orl_study_chart_write(&study, NULL, ORL_CANVAS_PNG, "/nowhere/at/all.png", &err),
        ORL_ERR_IO);
    assert_int_equal(orl_study_write_csv(&study, "/nowhere/at/all.csv", &err), ORL_ERR_IO);
    assert_non_null(strstr(err.message, "/nowhere/at/all.csv"));
    orl_study_done(&study);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ticks_are_round_and_apart),
        cmocka_unit_test(test_ticks_are_written_plainly),
        cmocka_unit_test(test_no_two_texts_meet),
        cmocka_unit_test(test_long_titles_and_names_are_cut),
        cmocka_unit_test(test_absurd_points_do_no_harm),
        cmocka_unit_test(test_svg_is_well_formed),
        cmocka_unit_test(test_png_shows_the_points),
        cmocka_unit_test(test_files_that_cannot_be_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
