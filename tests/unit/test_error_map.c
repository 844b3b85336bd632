/*
 * Error maps: relative errors, smoothing, files, the colour scale; and view names that would
 * collide with them.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <errno.h>
#include <png.h>

#include <oriel/job/run.h>

#include "render/picture/false_color.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/scratch.h"

/* A sanitizer's malloc cannot be replaced. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
#define CAN_FAIL 0
#else
#define CAN_FAIL 1
#endif

/* Number of malloc calls until one fails; 0: none fails. */
static unsigned fails_in;

#if CAN_FAIL
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);

static bool fails(void)
{
    if (fails_in == 0 || --fails_in > 0)
        return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return fails() ? NULL : __libc_realloc(old, size);
}
#endif

/* Returns a gray film of one value and error. */
static struct orl_film even_film(uint32_t width, uint32_t height, float value, float error)
{
    struct orl_film film;
    assert_int_equal(orl_film_init(&film, width, height, NULL), 0);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = value;
        film.errors[i] = error;
    }
    return film;
}

static void assert_near(double found, double wanted, double tolerance)
{
    if (!(fabs(found - wanted) <= tolerance))
        fail_msg("%.9g, not %.9g", found, wanted);
}

/* Floats hold seven digits. */
static void test_relative(void **state)
{
    struct orl_film film = even_film(10, 1, 2, 0.1F);
    (void)state;
    assert_near(orl_film_mean(&film), 2, 1e-6);
    assert_near(orl_film_relative_error(&film, 0, 2), 0.05, 1e-7);
    /* In the dark, a tenth of the mean is the floor. */
    film.pixels[3][0] = film.pixels[3][1] = film.pixels[3][2] = 0.02F;
    assert_near(orl_film_relative_error(&film, 3, 2), 0.5, 1e-6);
    film.errors[4] = 0;
    assert_true(orl_film_relative_error(&film, 4, 0) == 0);
    assert_true(orl_film_has_errors(&film));
    film.errors[4] = NAN;
    assert_false(orl_film_has_errors(&film));
    orl_film_done(&film);
}

/* Smoothing takes the mean of squares: of nine pixels, six at an edge, four in a corner; not
 * across a step. */
static void test_smoothing(void **state)
{
    struct orl_film film = even_film(8, 4, 1, 0.1F);
    (void)state;
    film.errors[8 + 1] = 0.7F;
    for (int y = 0; y < 4; y++)
        for (int c = 0; c < 3; c++) {
            film.pixels[y * 8 + 6][c] = film.pixels[y * 8 + 7][c] = 100;
            film.errors[y * 8 + 6] = film.errors[y * 8 + 7] = 5;
        }
    assert_int_equal(orl_film_smooth_errors(&film), 0);
    assert_near(film.errors[0], sqrt((0.49 + 3 * 0.01) / 4), 1e-6);
    assert_near(film.errors[1], sqrt((0.49 + 5 * 0.01) / 6), 1e-6);
    assert_near(film.errors[8 + 2], sqrt((0.49 + 8 * 0.01) / 9), 1e-6);
    assert_near(film.errors[3 * 8 + 5], 0.1, 1e-6);
    assert_near(film.errors[8 + 6], 5, 1e-6);
    orl_film_done(&film);
}

/* RGBE holds 8 bits: half a step is 1/256 of the value. */
static void test_hdr(void **state)
{
    struct orl_film film = even_film(16, 8, 3, 0.25F);
    struct orl_view view;
    double rgb[16 * 8][3];
    (void)state;
    film.errors[17] = 0.011F;
    assert_int_equal(orl_view_parse("-vtv -vp 1 2 3 -vd 1 0 0 -vh 60 -vv 30", &view, NULL), 0);
    assert_int_equal(orl_film_write_error_hdr(&film, &view, scratch_path("a.error.hdr"), NULL), 0);
    hdr_read(scratch_path("a.error.hdr"), 16, 8, rgb);
    for (int c = 0; c < 3; c++) {
        assert_near(rgb[0][c], 0.25, 0.25 / 128);
        assert_near(rgb[17][c], 0.011, 0.011 / 128);
    }
    orl_film_done(&film);
}

/* Returns the CIE lightness of an sRGB colour. */
static double lightness(const unsigned char srgb[3])
{
    static const double weights[3] = {0.2126, 0.7152, 0.0722};
    double y = 0;
    for (int c = 0; c < 3; c++) {
        const double s = srgb[c] / 255.0;
        y += weights[c] * (s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
    }
    return 116 * cbrt(y) - 16;
}

/* Returns the colour of a relative error from a thousandth to 1. */
static void color_of(double relative, unsigned char ret_srgb[3])
{
    orl_palette_color(ORL_PALETTE_EVEN, relative > 0 ? 1 + log10(relative) / 3 : 0, ret_srgb);
}

/* Equal ratios give equal steps of lightness, up to 8 bits and the interpolation between points. */
static void test_colors(void **state)
{
    unsigned char low[3], high[3], beyond[3];
    (void)state;
    color_of(1e-3, low);
    color_of(1, high);
    const double from = lightness(low), to = lightness(high);
    assert_true(to - from > 70);
    for (int i = 0; i <= 60; i++) {
        unsigned char color[3];
        color_of(pow(10, -3 + i / 20.0), color);
        assert_near(lightness(color), from + (to - from) * i / 60, 1);
    }
    color_of(0, beyond);
    assert_memory_equal(beyond, low, 3);
    color_of(INFINITY, beyond);
    assert_memory_equal(beyond, high, 3);
}

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

/* Checks the picture's colours from the top left and the legend below; small pictures leave room
 * for it. */
static void check_png(uint32_t width, uint32_t height)
{
    struct orl_film film = even_film(width, height, 1, 0.02F);
    unsigned char color[3];
    png_image image;
    bool dark = false;
    assert_int_equal(orl_film_write_error_png(&film, scratch_path("b.error.png"), NULL), 0);
    png_bytep pixels = read_png(scratch_path("b.error.png"), &image);
    assert_true(image.width >= width && image.width >= 200 && image.height >= height + 40);
    color_of(0.02, color);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            assert_memory_equal(pixels + 3 * ((size_t)y * image.width + x), color, 3);
    for (size_t i = (size_t)height * image.width; i < (size_t)image.height * image.width; i++)
        dark = dark || pixels[3 * i] + pixels[3 * i + 1] + pixels[3 * i + 2] < 200;
    assert_true(dark);
    free(pixels);
    orl_film_done(&film);
}

static void test_png(void **state)
{
    (void)state;
    check_png(1, 1);
    check_png(400, 300);
    check_png(1500, 20);
}

static void test_unwritable(void **state)
{
    struct orl_film film = even_film(2, 2, 1, 1);
    struct orl_error err;
    (void)state;
    assert_int_equal(orl_film_write_error_png(&film, scratch_path("no/a.png"), &err), ORL_ERR_IO);
    orl_film_done(&film);
}

/* If any single allocation fails, the result is a complete picture or an error. */
static void test_whole_or_not_at_all(void **state)
{
    struct orl_film film;
    size_t whole_size, size, refused = 0;
    char path[128];
    struct orl_error err;
    bool more = true;
    (void)state;
    if (!CAN_FAIL)
        skip();
    film = even_film(600, 2, 1, 0.02F);
    snprintf(path, sizeof path, "%s", scratch_path("whole.png"));
    assert_int_equal(orl_film_write_error_png(&film, path, NULL), 0);
    unsigned char *whole = scene_read_bytes(path, &whole_size);
    for (unsigned call = 1; more; call++) {
        fails_in = call;
        const int code = orl_film_write_error_png(&film, path, &err);
        more = fails_in == 0;
        fails_in = 0;
        refused += code < 0;
        if (code < 0) {
            assert_int_equal(err.code, ORL_ERR_NOMEM);
            continue;
        }
        unsigned char *bytes = scene_read_bytes(path, &size);
        assert_int_equal(size, whole_size);
        assert_memory_equal(bytes, whole, size);
        free(bytes);
    }
    print_message("# %zu refused\n", refused);
    assert_true(refused > 3);
    free(whole);
    orl_film_done(&film);
}

/* "a.error" would write a.error.hdr twice. */
static void test_names(void **state)
{
    static char view[] = "-vtv -vp 0 0 0 -vd 1 0 0", a[] = "a", a_error[] = "a.error",
                other[] = "ab.error", file[] = "scene.rad";
    char *files[] = {file};
    struct orl_view_request views[2] = {{.name = a, .view = view, .width = 4, .height = 4},
                                        {.name = a_error, .view = view, .width = 4, .height = 4}};
    struct orl_job job;
    struct orl_error err;
    (void)state;
    orl_job_init(&job);
    job.scene_files = files;
    job.n_scene_files = 1;
    job.views = views;
    job.n_views = 2;
    assert_int_equal(orl_job_validate(&job, &err), ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "'a.error'"));
    views[0].name = a_error;
    views[1].name = a;
    assert_int_equal(orl_job_validate(&job, &err), ORL_ERR_INVALID);
    views[0].name = other;
    assert_int_equal(orl_job_validate(&job, &err), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_relative), cmocka_unit_test(test_smoothing),
        cmocka_unit_test(test_hdr),      cmocka_unit_test(test_colors),
        cmocka_unit_test(test_png),      cmocka_unit_test(test_unwritable),
        cmocka_unit_test(test_names),    cmocka_unit_test(test_whole_or_not_at_all),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
