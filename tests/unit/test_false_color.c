/*
 * False colours: palettes and scales against their formulas, contour lines at their values, and
 * pictures as read by libpng.
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
#include <png.h>

#include <oriel/base/vec.h>

#include "base/statistics/numeric.h"
#include "render/picture/false_color.h"
#include "run/request/job_inputs.h"
#include "support/scratch.h"

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

enum { WIDTH = 320, HEIGHT = 240 };

/* Returns a gray film, from 0 at the left to that many cd/m2 at the right. */
static struct orl_film ramp(double high)
{
    struct orl_film film;
    assert_int_equal(orl_film_init(&film, WIDTH, HEIGHT, NULL), 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = (float)(high / ORL_EFFICACY_LM_PER_W * (i % WIDTH + 0.5) / WIDTH);
    return film;
}

static struct orl_scale scale_of(const struct orl_film *film, struct orl_false_color how)
{
    struct orl_scale scale;
    assert_int_equal(orl_scale_make(&scale, film, &how, false), 0);
    return scale;
}

static void expect_color(enum orl_palette palette, double share, int r, int g, int b)
{
    unsigned char color[3];
    orl_palette_color(palette, share, color);
    if (color[0] != r || color[1] != g || color[2] != b)
        fail_msg("%s at %g: %d %d %d instead of %d %d %d", orl_palette_name(palette), share,
                 color[0], color[1], color[2], r, g, b);
}

/* Worked out by hand from falsecolor's manual and functions, with a gamma of 2.2. */
static void test_palettes(void **state)
{
    (void)state;
    expect_color(ORL_PALETTE_HOT, 0.5, 255, 128, 0);
    expect_color(ORL_PALETTE_HOT, 1, 255, 255, 255);
    expect_color(ORL_PALETTE_ECO, 0, 0, 0, 255);
    expect_color(ORL_PALETTE_ECO, 0.75, 255, 128, 0);
    expect_color(ORL_PALETTE_PM3D, 0.25, 128, 4, 255);
    expect_color(ORL_PALETTE_SPEC, 0, 0, 0, 255);
    expect_color(ORL_PALETTE_SPEC, 0.375, 0, 255, 0);
    expect_color(ORL_PALETTE_SPEC, 1, 255, 0, 0);
    expect_color(ORL_PALETTE_DEF, 0.5, 145, 115, 89);
    expect_color(ORL_PALETTE_DEF, 2, 253, 252, 48);
    expect_color(ORL_PALETTE_EVEN, -1, 28, 18, 107);
    expect_color(ORL_PALETTE_EVEN, 2, 245, 232, 112);
}

static void test_kth(void **state)
{
    double values[101];
    (void)state;
    for (int k = 0; k < 101; k += 10) {
        for (int i = 0; i < 101; i++)
            values[i] = (i * 37) % 101;
        assert_true(orl_nth_element(values, 101, (size_t)k) == k);
    }
}

/* With divisions as falsecolor's -s, -n and -log; without them, round numbers. */
static void test_scales(void **state)
{
    (void)state;
    struct orl_film film = ramp(3000);
    const struct orl_scale linear =
        scale_of(&film, (struct orl_false_color){.scale = 1000, .divisions = 8});
    assert_int_equal(linear.n_levels, 8);
    assert_near(linear.levels[0], 125, 1e-9);
    assert_near(orl_scale_share(&linear, 250), 0.25, 1e-12);
    assert_int_equal(orl_scale_band(&linear, 250), 2);
    const struct orl_scale logs =
        scale_of(&film, (struct orl_false_color){.scale = 1000, .divisions = 4, .decades = 2});
    assert_near(logs.levels[0], 1000 * pow(10, -1.5), 1e-9);
    assert_near(logs.levels[3], 1000, 1e-9);
    assert_near(orl_scale_share(&logs, 100), 0.5, 1e-12);
    assert_near(orl_scale_share(&logs, 9), 0, 0);
    const struct orl_scale found = scale_of(&film, (struct orl_false_color){.asked = true});
    assert_near(found.top, 5000, 1e-6);
    assert_int_equal(found.n_levels, 10);
    assert_near(found.levels[3], 2000, 1e-6);
    const struct orl_scale decades =
        scale_of(&film, (struct orl_false_color){.scale = 2000, .decades = 2});
    static const double expected[] = {50, 100, 200, 500, 1000, 2000};
    assert_int_equal(decades.n_levels, 6);
    for (int i = 0; i < 6; i++)
        assert_near(decades.levels[i], expected[i], 1e-6);
    const struct orl_scale other =
        scale_of(&film, (struct orl_false_color){.scale = 10, .multiplier = 2, .label = "W"});
    assert_near(orl_scale_value(&other, (const float[3]){3, 3, 3}), 6, 1e-6);
    assert_string_equal(other.unit, "W");
    orl_film_done(&film);
}

/* Black films have a scale too. */
static void test_dark_scale(void **state)
{
    (void)state;
    struct orl_film film = ramp(0);
    const struct orl_scale scale = scale_of(&film, (struct orl_false_color){.decades = 3});
    assert_true(scale.top == 1 && scale.n_levels > 0);
    orl_film_done(&film);
}

/* ---- Pictures -------------------------------------------------------------------------------- */

static png_bytep read_png(const char *path, png_image *ret_image)
{
    memset(ret_image, 0, sizeof *ret_image);
    ret_image->version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(ret_image, path));
    ret_image->format = PNG_FORMAT_RGB;
    png_bytep pixels = malloc(PNG_IMAGE_SIZE(*ret_image));
    assert_non_null(pixels);
    assert_true(png_image_finish_read(ret_image, NULL, pixels, 0, NULL));
    return pixels;
}

static png_bytep write_and_read(const struct orl_film *film, struct orl_false_color how,
                                enum orl_picture picture, png_image *ret_image)
{
    const struct orl_scale scale = scale_of(film, how);
    const struct orl_display display = {.tone = ORL_TONE_EXPOSURE, .exposure = 1e-6};
    struct orl_view view;
    struct orl_tonemapped tonemapped;
    assert_int_equal(orl_view_parse("-vtv", &view, NULL), 0);
    assert_int_equal(orl_tonemapped_init(&tonemapped, film, &view, &display), 0);
    const int code = orl_false_color_write(film, &tonemapped, &scale, &how, picture,
                                           scratch_path("a.png"), NULL);
    orl_tonemapped_done(&tonemapped);
    assert_int_equal(code, 0);
    return read_png(scratch_path("a.png"), ret_image);
}

/* Each pixel has the colour of its value; a legend is below. */
static void test_fill(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(1000);
    const struct orl_false_color how = {.scale = 1000, .palette = ORL_PALETTE_HOT};
    png_bytep pixels = write_and_read(&film, how, ORL_PICTURE_FALSE, &image);
    assert_int_equal(image.width, WIDTH);
    assert_true(image.height > HEIGHT + 40);
    for (int x = 0; x < WIDTH; x++) {
        unsigned char color[3];
        orl_palette_color(ORL_PALETTE_HOT, (x + 0.5) / WIDTH, color);
        assert_memory_equal(pixels + 3 * (7 * WIDTH + x), color, 3);
    }
    free(pixels);
    orl_film_done(&film);
}

/* Counts pixels of a picture row that are not black; returns the middle of those near x. */
static int lit_about(png_bytep pixels, int row, double x, int reach, double *ret_middle)
{
    int count = 0;
    double sum = 0;
    for (int k = (int)x - reach; k <= (int)x + reach; k++) {
        const png_byte *p = pixels + 3 * (row * WIDTH + k);
        if (p[0] + p[1] + p[2] > 60) {
            sum += k + 0.5;
            count++;
        }
    }
    *ret_middle = count ? sum / count : 0;
    return count;
}

/* Contour lines of a ramp are at its levels; each has its number written on it, once. */
static void test_lines(void **state)
{
    (void)state;
    png_image image;
    double middle;
    struct orl_film film = ramp(1000);
    const struct orl_false_color how = {.scale = 800, .divisions = 4};
    png_bytep pixels = write_and_read(&film, how, ORL_PICTURE_LINES, &image);
    int right = 0;
    for (int i = 1; i < 4; i++)
        for (int y = 0; y < HEIGHT; y++) {
            const int lit = lit_about(pixels, y, WIDTH * 0.2 * i, 20, &middle);
            assert_true(lit > 0);
            right += lit <= 6 && fabs(middle - WIDTH * 0.2 * i) < 1;
        }
    /* All rows of the three lines, minus the rows that their numbers cover: some 30 each. */
    assert_true(right > 3 * (HEIGHT - 50) && right < 3 * (HEIGHT - 15));
    assert_int_equal(lit_about(pixels, 100, WIDTH * 0.3, 20, &middle), 0);
    free(pixels);
    orl_film_done(&film);
}

/* An edge between dark and bright is not a contour line, for any levels between. */
static void test_edges_are_no_lines(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = i % WIDTH < WIDTH / 2 ? 0.1F : 5;
    png_bytep pixels = write_and_read(
        &film, (struct orl_false_color){.scale = 1000, .divisions = 8}, ORL_PICTURE_LINES, &image);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        assert_true(pixels[i] < 20);
    free(pixels);
    orl_film_done(&film);
}

/* Bands extend a tenth of a step to either side of a level, as in falsecolor's -cb. */
static void test_bands(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(1000);
    const struct orl_false_color how = {.scale = 800, .divisions = 4, .palette = ORL_PALETTE_ECO};
    png_bytep pixels = write_and_read(&film, how, ORL_PICTURE_BANDS, &image);
    for (int x = 0; x < WIDTH; x++) {
        const double v = 4 * 1000 * (x + 0.5) / WIDTH / 800, off = fabs(v - round(v));
        const png_byte *p = pixels + 3 * (100 * WIDTH + x);
        const bool on = p[0] + p[1] + p[2] > 60;
        if (fabs(off - 0.1) > 1e-3)
            assert_int_equal(on, round(v) >= 1 && round(v) <= 4 && off < 0.1);
    }
    free(pixels);
    orl_film_done(&film);
}

/* A point's value is its pixel's; points and extrema are marked. */
static void test_points(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(1000);
    struct orl_picture_point point = {"here", 100.2, 50};
    struct orl_false_color how = {.scale = 1000, .points = &point, .n_points = 1, .extrema = true};
    const struct orl_scale scale = scale_of(&film, how);
    assert_near(orl_false_color_at(&film, &scale, 100.2, 50), 1000 * 100.5 / WIDTH, 1e-3);
    assert_near(orl_false_color_at(&film, &scale, WIDTH, HEIGHT), 1000 * (WIDTH - 0.5) / WIDTH,
                1e-3);
    png_bytep pixels = write_and_read(&film, how, ORL_PICTURE_FALSE, &image);
    unsigned char under[3];
    orl_palette_color(ORL_PALETTE_EVEN, 100.5 / WIDTH, under);
    assert_memory_not_equal(pixels + 3 * (50 * WIDTH + 100), under, 3);
    free(pixels);
    const struct orl_scale wide = scale_of(&film, how);
    struct orl_error err;
    assert_int_equal(orl_false_color_write(&film, NULL, &wide, &how, ORL_PICTURE_FALSE,
                                           scratch_path("no/a.png"), &err),
                     ORL_ERR_IO);
    orl_film_done(&film);
}

/* A point within the requested size but outside the picture after adjusting for pixel aspect is
 * refused before rendering. */
static void test_points_of_less(void **state)
{
    static char name[] = "eye", scene[] = "room.rad", *files[] = {scene},
                text[] = "-vtv -vp 0 0 0 -vd 0 1 0 -vh 90 -vv 45 -pa 1";
    struct orl_view_request *views, view = {.name = name,
                                            .view = text,
                                            .width = WIDTH,
                                            .height = HEIGHT,
                                            .false_color = {.asked = true, .n_points = 1}};
    const struct orl_files no_files = {.ctx = NULL};
    struct orl_error err = {0};
    struct orl_job job;
    (void)state;
    orl_job_init(&job);
    job.scene_files = files;
    job.n_scene_files = 1;
    job.views = &view;
    job.n_views = 1;
    for (int inside = 0; inside < 2; inside++) {
        struct orl_picture_point point = {.name = "p", .x = 160, .y = inside ? 130 : 140};
        view.false_color.points = &point;
        const int code = orl_run_resolve_views(&job, &no_files, &views, &err);
        assert_int_equal(code, inside ? 0 : ORL_ERR_RANGE);
        assert_int_equal(views[0].height, 133); /* tan 22.5 / tan 45 of 320 */
        orl_run_views_done(&job, views);
    }
    assert_non_null(strstr(err.message, "'p' at 160, 140 lies outside"));
}

/* Printed numbers have three digits, and no exponents at ordinary sizes. */
static void test_texts(void **state)
{
    static const struct {
        double value;
        const char *text;
    } known[] = {{0, "0"},       {0.1234, "0.123"}, {12.34, "12.3"},   {999.6, "1000"},
                 {1234, "1234"}, {12345, "12350"},  {250000, "250000"}};
    char text[16];
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        orl_scale_text(known[i].value, text);
        assert_string_equal(text, known[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_palettes),
        cmocka_unit_test(test_kth),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_dark_scale),
        cmocka_unit_test(test_fill),
        cmocka_unit_test(test_lines),
        cmocka_unit_test(test_edges_are_no_lines),
        cmocka_unit_test(test_bands),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_points_of_less),
        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
