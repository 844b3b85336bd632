/* Pictures for display: tone curves, hue, and PNG files read by libpng. */
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

#include "render/picture/display.h"
#include "support/scratch.h"

enum { WIDTH = 64, HEIGHT = 48 };

static struct orl_view some_view(void)
{
    struct orl_view view;
    assert_int_equal(orl_view_parse("-vtv -vh 60 -vv 45", &view, NULL), 0);
    return view;
}

/* Returns a gray ramp from left to right over that many decades of luminance, from the least,
 * cd/m2. */
static struct orl_film ramp(double least, double decades)
{
    struct orl_film film;
    assert_int_equal(orl_film_init(&film, WIDTH, HEIGHT, NULL), 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = (float)(least / ORL_EFFICACY_LM_PER_W *
                                        pow(10, decades * (i % WIDTH) / (WIDTH - 1)));
    return film;
}

static struct orl_tonemapped show(const struct orl_film *film, struct orl_display how)
{
    const struct orl_view view = some_view();
    struct orl_tonemapped tonemapped;
    assert_int_equal(orl_tonemapped_init(&tonemapped, film, &view, &how), 0);
    return tonemapped;
}

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.9g is not %.9g +- %.2g", value, expected, tolerance);
}

static double shown_at(const struct orl_tonemapped *tonemapped, uint32_t x)
{
    float rgb[3];
    orl_tonemapped_pixel(tonemapped, x, 1, rgb);
    assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
    assert_true(rgb[0] >= 0 && rgb[0] <= 1);
    return rgb[0];
}

/* ---- The tone mapper of the eye -------------------------------------------------------------- */

/* The five parts of Ferwerda et al.'s fit agree at their joints, within the two digits of its
 * constants. */
static void test_thresholds(void **state)
{
    static const double joints[] = {-3.94, -1.44, -0.0184, 1.9};
    (void)state;
    for (size_t i = 0; i < sizeof joints / sizeof *joints; i++) {
        const double below = orl_visible_difference(pow(10, joints[i] - 1e-6));
        const double above = orl_visible_difference(pow(10, joints[i] + 1e-6));
        assert_true(fabs(log10(above / below)) < 0.02);
    }
    assert_near(orl_visible_difference(1e4), pow(10, 4 - 1.255), 1e-6);
    /* Shlaer's acuity: some 2 cycles per degree at the threshold, 50 by day. */
    assert_true(orl_acuity(1e-4) > 1 && orl_acuity(1e-4) < 3);
    assert_true(orl_acuity(1000) > 45 && orl_acuity(1000) < 55);
}

/*
 * Five decades are mapped in order, from black to white, and nowhere with more contrast than the
 * scene. Between neighbours the display has no more thresholds than the scene, except for the
 * trimming (2.5 %) and the width of a bin.
 */
static void test_human(void **state)
{
    (void)state;
    struct orl_film film = ramp(0.1, 5);
    struct orl_tonemapped tonemapped = show(&film, (struct orl_display){.tone = ORL_TONE_HUMAN});
    assert_true(tonemapped.tonemap.factor == 0);
    for (uint32_t x = 1; x < WIDTH; x++) {
        const double low = 1 + 99 * shown_at(&tonemapped, x - 1),
                     high = 1 + 99 * shown_at(&tonemapped, x);
        const double a = 0.1 * pow(10, 5.0 * (x - 1) / (WIDTH - 1));
        const double b = 0.1 * pow(10, 5.0 * x / (WIDTH - 1));
        assert_true(high >= low);
        const double seen = (high - low) / orl_visible_difference(sqrt(high * low));
        const double there = (b - a) / orl_visible_difference(sqrt(a * b));
        assert_true(seen < 1.35 * there);
    }
    assert_true(shown_at(&tonemapped, 1) < 0.02);
    assert_true(shown_at(&tonemapped, WIDTH - 1) > 0.9);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
}

/* A dynamic range that the display can show is mapped linearly. */
static void test_human_in_proportion(void **state)
{
    (void)state;
    struct orl_film film = ramp(20, 0.5);
    struct orl_tonemapped tonemapped = show(&film, (struct orl_display){.tone = ORL_TONE_HUMAN});
    assert_true(tonemapped.tonemap.factor > 0);
    assert_near(shown_at(&tonemapped, 20) / shown_at(&tonemapped, 2),
                pow(10, 0.5 * 18 / (WIDTH - 1)), 1e-5);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
}

/* A bright half scatters light (veil) into the dark one, more of it nearby, at most 8 %. Beyond
 * the picture's edge the scene is assumed to be like the inside. */
static void test_veil(void **state)
{
    (void)state;
    const struct orl_view view = some_view();
    struct orl_film film;
    struct orl_fovea fovea;
    assert_int_equal(orl_film_init(&film, WIDTH, HEIGHT, NULL), 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = i % WIDTH < WIDTH / 2 ? 0 : 100;
    assert_int_equal(orl_fovea_init(&fovea, &film, &view), 0);
    assert_int_equal(orl_fovea_add_veiling(&fovea, &view), 0);
    double before = 0;
    for (int x = WIDTH / 8; x < WIDTH / 2; x++) {
        float rgb[3] = {0, 0, 0};
        orl_fovea_mix_veiling(&fovea, (x + 0.5) / WIDTH, 0.5, rgb);
        if (!(rgb[0] >= before && rgb[0] < 8))
            fail_msg("%d: %g after %g", x, (double)rgb[0], before);
        before = rgb[0];
    }
    assert_true(before > 2);
    orl_fovea_done(&fovea);
    orl_film_done(&film);
}

/* A fine chequer is visible by day, and gray by night; both keep their mean. */
static void test_acuity(void **state)
{
    static const double levels[] = {100, 1e-5};
    (void)state;
    struct orl_view view;
    assert_int_equal(orl_view_parse("-vtv -vh 6 -vv 4.5", &view, NULL), 0);
    for (int k = 0; k < 2; k++) {
        struct orl_film film;
        struct orl_fovea fovea;
        struct orl_blur blur;
        double sum = 0, contrast = 0;
        assert_int_equal(orl_film_init(&film, 256, 192, NULL), 0);
        for (int i = 0; i < 256 * 192; i++)
            for (int c = 0; c < 3; c++)
                film.pixels[i][c] = (float)(levels[k] * ((i ^ (i / 256)) & 1 ? 1.5 : 0.5));
        assert_int_equal(orl_fovea_init(&fovea, &film, &view), 0);
        assert_int_equal(orl_blur_init(&blur, &film, &view), 0);
        for (uint32_t x = 0; x < 256; x++) {
            float rgb[3];
            orl_blur_at(&blur, &fovea, x, 96, rgb);
            sum += rgb[0] / levels[k] / 256;
            contrast = fmax(contrast, fabs(rgb[0] / levels[k] - 1));
        }
        assert_near(sum, 1, 0.01);
        assert_near(contrast, k == 0 ? 0.5 : 0, k == 0 ? 1e-6 : 0.1);
        orl_blur_done(&blur);
        orl_fovea_done(&fovea);
        orl_film_done(&film);
    }
}

/* By night a red becomes gray; by day it stays as it is. */
static void test_color_loss(void **state)
{
    static const double levels[] = {100, 1e-6};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct orl_film film = ramp(1, 1);
        float rgb[3];
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            film.pixels[i][0] = (float)levels[k];
            film.pixels[i][1] = film.pixels[i][2] = (float)(0.2 * levels[k]);
        }
        struct orl_tonemapped tonemapped = show(&film, (struct orl_display){.color_loss = true});
        orl_tonemapped_pixel(&tonemapped, 3, 3, rgb);
        assert_true(rgb[0] > 0);
        assert_near(rgb[1] / rgb[0], k == 0 ? 0.2 : 1, 1e-5);
        orl_tonemapped_done(&tonemapped);
        orl_film_done(&film);
    }
}

/* ---- Linear mapping -------------------------------------------------------------------------- */

/* White is at 1 / exposure; brighter values stay white; colours keep their hue. */
static void test_exposure(void **state)
{
    (void)state;
    struct orl_film film = ramp(1, 1);
    float rgb[3];
    const struct orl_display how = {.tone = ORL_TONE_EXPOSURE, .exposure = 0.5};
    const float colors[][3] = {{1, 1, 1}, {5, 5, 5}, {0.4F, 0.2F, 0.1F}, {6, 0.5F, 0.5F}};
    memcpy(film.pixels, colors, sizeof colors);
    struct orl_tonemapped tonemapped = show(&film, how);
    orl_tonemapped_pixel(&tonemapped, 0, 0, rgb);
    assert_near(rgb[1], 0.5, 1e-6);
    orl_tonemapped_pixel(&tonemapped, 1, 0, rgb);
    assert_near(rgb[2], 1, 1e-6);
    orl_tonemapped_pixel(&tonemapped, 2, 0, rgb);
    assert_near(rgb[0], 0.2, 1e-6);
    assert_near(rgb[2], 0.05, 1e-6);
    /* Too red for any display: its channel is full, the others keep their order and brightness. */
    const double bright = 0.5 * (6 * ORL_LUMA_R + 0.5 * (ORL_LUMA_G + ORL_LUMA_B));
    orl_tonemapped_pixel(&tonemapped, 3, 0, rgb);
    assert_near(rgb[0], 1, 1e-6);
    assert_near(ORL_LUMA_R * rgb[0] + ORL_LUMA_G * rgb[1] + ORL_LUMA_B * rgb[2], bright, 1e-5);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
    /* The photographers' rule for a sunny day: EV 15, white at 1.2 * 2^15 cd/m2. */
    assert_near(1 / orl_exposure_of_ev(15), 39321.6 / 179, 1e-9);
}

static void test_linear(void **state)
{
    (void)state;
    struct orl_film film = ramp(50, 0);
    struct orl_tonemapped tonemapped = show(&film, (struct orl_display){.tone = ORL_TONE_LINEAR});
    assert_near(shown_at(&tonemapped, 5), 0.18, 1e-6);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static png_bytep read_png(const char *path, png_image *ret_image, png_uint_32 format)
{
    memset(ret_image, 0, sizeof *ret_image);
    ret_image->version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(ret_image, path));
    ret_image->format = format;
    png_bytep pixels = malloc(PNG_IMAGE_SIZE(*ret_image));
    assert_non_null(pixels);
    assert_true(png_image_finish_read(ret_image, NULL, pixels, 0, NULL));
    return pixels;
}

/* A ramp stays a ramp; NaN is black, and so is a film of zeros. */
static void test_png(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(1, 4);
    film.pixels[WIDTH][0] = film.pixels[WIDTH][1] = film.pixels[WIDTH][2] = NAN;
    film.pixels[WIDTH + 1][1] = INFINITY;
    film.pixels[WIDTH + 2][0] = -1000;
    struct orl_tonemapped tonemapped = show(&film, (struct orl_display){.tone = ORL_TONE_HUMAN});
    assert_int_equal(orl_tonemapped_write_png(&tonemapped, 8, scratch_path("a.png"), NULL), 0);
    png_bytep pixels = read_png(scratch_path("a.png"), &image, PNG_FORMAT_RGB);
    assert_int_equal(image.width, WIDTH);
    assert_int_equal(image.height, HEIGHT);
    for (int x = 1; x < WIDTH; x++)
        assert_true(pixels[3 * x] >= pixels[3 * x - 3]);
    assert_true(pixels[3 * (WIDTH - 1)] > pixels[0] + 100);
    assert_memory_equal(pixels + 3 * WIDTH, "\0\0\0\0\0\0\0\0\0", 9);
    free(pixels);
    orl_tonemapped_done(&tonemapped);
    memset(film.pixels, 0, sizeof *film.pixels * WIDTH * HEIGHT);
    tonemapped = show(&film, (struct orl_display){.tone = ORL_TONE_HUMAN});
    assert_int_equal(orl_tonemapped_write_png(&tonemapped, 8, scratch_path("b.png"), NULL), 0);
    pixels = read_png(scratch_path("b.png"), &image, PNG_FORMAT_RGB);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        assert_int_equal(pixels[i], 0);
    free(pixels);
    struct orl_error err;
    assert_int_equal(orl_tonemapped_write_png(&tonemapped, 8, scratch_path("no/a.png"), &err),
                     ORL_ERR_IO);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
}

/* 16 bits represent the shown values to half a step; libpng's reader approximates sRGB's curve by
 * 2.2. */
static void test_png_16(void **state)
{
    (void)state;
    png_image image;
    struct orl_film film = ramp(1, 2);
    const struct orl_display how = {.tone = ORL_TONE_EXPOSURE, .exposure = 1.79};
    struct orl_tonemapped tonemapped = show(&film, how);
    assert_int_equal(orl_tonemapped_write_png(&tonemapped, 16, scratch_path("c.png"), NULL), 0);
    png_bytep pixels = read_png(scratch_path("c.png"), &image, PNG_FORMAT_LINEAR_RGB);
    const png_uint_16 *words = (const png_uint_16 *)(const void *)pixels;
    for (uint32_t x = 0; x < WIDTH; x++)
        assert_near(words[3 * (WIDTH + x)] / 65535.0,
                    pow(orl_srgb(shown_at(&tonemapped, x), UINT16_MAX) / 65535.0, 2.2), 5e-5);
    /* 8 bits would give a tenth as many. */
    int steps = 0;
    for (int x = 1; x < WIDTH; x++)
        steps += words[3 * x] != words[3 * x - 3];
    assert_int_equal(steps, WIDTH - 1);
    free(pixels);
    orl_tonemapped_done(&tonemapped);
    orl_film_done(&film);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thresholds),
        cmocka_unit_test(test_human),
        cmocka_unit_test(test_human_in_proportion),
        cmocka_unit_test(test_veil),
        cmocka_unit_test(test_acuity),
        cmocka_unit_test(test_color_loss),
        cmocka_unit_test(test_exposure),
        cmocka_unit_test(test_linear),
        cmocka_unit_test(test_png),
        cmocka_unit_test(test_png_16),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
