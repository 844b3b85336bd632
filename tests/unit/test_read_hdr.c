/*
 * Reading of Radiance pictures: our own files, flat and run-length encoded by component; by pixel,
 * as old programs wrote; exposures; orders of scanlines; and refusals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/film/image_files.h"
#include "support/cli.h"
#include "support/scene_text.h"

#define HEAD "#?RADIANCE\nVIEW= -vta -vh 180 -vv 180\nFORMAT=32-bit_rle_rgbe\n"

static struct orl_hdr_picture read_bytes(const void *bytes, size_t size)
{
    struct orl_hdr_picture picture = {.has_view = false};
    struct orl_error err = {0};
    if (orl_hdr_read("a.hdr", bytes, size, &picture, &err) < 0)
        fail_msg("%s", err.message);
    return picture;
}

/* Writes and reads a picture of that size, with runs and without: values agree within RGBE's step
 * of 1/256 of the largest channel. */
static void round_trip(uint32_t width, uint32_t height)
{
    struct orl_film film = {0};
    struct orl_view view;
    char folder[64], path[128];
    size_t size;
    assert_int_equal(orl_film_init(&film, width, height, NULL), 0);
    for (uint32_t i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] =
                i % 40 < 20 ? 3.5F : (float)((i * 7 + (uint32_t)c * 3) % 11) + 0.01F;
    assert_int_equal(orl_view_parse("-vtv -vh 90 -vv 90", &view, NULL), 0);
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/a.hdr", folder);
    assert_int_equal(orl_film_write_hdr(&film, &view, path, NULL), 0);
    unsigned char *bytes = scene_read_bytes(path, &size);
    struct orl_hdr_picture read = read_bytes(bytes, size);
    assert_int_equal(read.film.width, width);
    assert_int_equal(read.film.height, height);
    assert_true(read.has_view && read.view.type == 'v' && read.view.horizontal == 90);
    for (uint32_t i = 0; i < width * height; i++) {
        const float most = fmaxf(fmaxf(film.pixels[i][0], film.pixels[i][1]), film.pixels[i][2]);
        for (int c = 0; c < 3; c++)
            assert_true(fabsf(read.film.pixels[i][c] - film.pixels[i][c]) <= most / 128);
    }
    orl_hdr_done(&read);
    orl_film_done(&film);
    free(bytes);
    cli_remove_folder(folder);
}

static void test_written_and_read(void **state)
{
    (void)state;
    round_trip(64, 5);
    round_trip(7, 3); /* too narrow for runs */
    round_trip(300, 2);
}

/* Pixels of 1/2 (128, 1/256 of 2^0 each, and the half), read in the order of the file. */
static void check_order(const char *order, const int wanted[4])
{
    unsigned char bytes[256];
    const int head = snprintf((char *)bytes, sizeof bytes, HEAD "\n%s\n", order);
    for (int i = 0; i < 4; i++)
        memcpy(bytes + head + 4 * i, (unsigned char[4]){(unsigned char)(10 * i + 20), 0, 0, 128},
               4);
    struct orl_hdr_picture p = read_bytes(bytes, (size_t)head + 16);
    for (int i = 0; i < 4; i++)
        assert_true(p.film.pixels[i][0] == (float)((10 * wanted[i] + 20.5) / 256));
    orl_hdr_done(&p);
}

static void test_orders(void **state)
{
    (void)state;
    check_order("-Y 2 +X 2", (int[4]){0, 1, 2, 3});
    check_order("+Y 2 +X 2", (int[4]){2, 3, 0, 1});
    check_order("-Y 2 -X 2", (int[4]){1, 0, 3, 2});
    check_order("+X 2 -Y 2", (int[4]){0, 2, 1, 3});
    check_order("-X 2 +Y 2", (int[4]){3, 1, 2, 0});
}

static void test_exposures(void **state)
{
    static const char bytes[] = "#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4\nCOLORCORR= 1 .5 2\n"
                                "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x7f\x7f\x7f\x81";
    struct orl_hdr_picture p = read_bytes(bytes, sizeof bytes - 1);
    (void)state;
    const double value = 127.5 / 128;
    assert_true(p.film.pixels[0][0] == (float)(value / 8));
    assert_true(p.film.pixels[0][1] == (float)(value / 4));
    assert_true(p.film.pixels[0][2] == (float)(value / 16));
    assert_false(p.has_view);
    orl_hdr_done(&p);
}

/* A pixel and 259 repeats of it: 3, then 1 times 256. */
static void test_old_runs(void **state)
{
    static const char bytes[] =
        HEAD "\n-Y 1 +X 260\n\x20\x30\x40\x80\x01\x01\x01\x03\x01\x01\x01\x01";
    struct orl_hdr_picture p = read_bytes(bytes, sizeof bytes - 1);
    (void)state;
    for (int i = 0; i < 260; i++)
        assert_true(p.film.pixels[i][1] == (float)(48.5 / 256));
    orl_hdr_done(&p);
}

/* A header from before 1992: no "#?", but a format, which is all that Radiance requires. */
static void test_without_magic(void **state)
{
    static const char bytes[] = "ra_t16 -r\nFORMAT=32-bit_rle_rgbe\npfilt -x 1\nEXPOSURE=2\n\n"
                                "-Y 1 +X 1\n\x7f\x7f\x7f\x81";
    struct orl_hdr_picture p = read_bytes(bytes, sizeof bytes - 1);
    (void)state;
    assert_true(p.film.pixels[0][1] == (float)(127.5 / 128 / 2));
    orl_hdr_done(&p);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text;
        int code;
    } cases[] = {
        {"", ORL_ERR_SYNTAX},
        {"P6\n", ORL_ERR_SYNTAX},
        {"pfilt\n\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\nabcd", ORL_ERR_SYNTAX},
        {"pfilt\nFORMAT=ascii\n\n-Y 1 +X 1\nabcd", ORL_ERR_SYNTAX},
        {"#?RADIANCE\n", ORL_ERR_SYNTAX},
        {HEAD "\n", ORL_ERR_SYNTAX},
        {HEAD "\n-Y 1 +Y 1\nabcd", ORL_ERR_SYNTAX},
        {HEAD "\n-Y 0 +X 1\n", ORL_ERR_LIMIT},
        {HEAD "\n-Y 99999 +X 1\n", ORL_ERR_LIMIT},
        {HEAD "\n-Y 16000 +X 16000\n", ORL_ERR_LIMIT},
        {HEAD "\n-Y 1 +X 2\nabcd", ORL_ERR_SYNTAX},
        {HEAD "\n-Y 1 +X 2\n\x01\x01\x01\x01", ORL_ERR_SYNTAX},
        {HEAD "\n-Y 1 +X 2\nabcd\x01\x01\x01\x05", ORL_ERR_SYNTAX},
        {HEAD "\n-Y 1 +X 9\n\x02\x02\x01\x01xxxx", ORL_ERR_SYNTAX},
        {HEAD "EXPOSURE=0\n\n-Y 1 +X 1\nabcd", ORL_ERR_SYNTAX},
        {HEAD "EXPOSURE=1e300\nEXPOSURE=1e300\n\n-Y 1 +X 1\nabcd", ORL_ERR_RANGE},
        {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", ORL_ERR_UNSUPPORTED},
        {"#?RADIANCE\nVIEW= -vta -vh 900\n\n-Y 1 +X 1\nabcd", ORL_ERR_RANGE},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_hdr_picture picture;
        struct orl_error err = {0};
        const int code =
            orl_hdr_read("a.hdr", cases[i].text, strlen(cases[i].text), &picture, &err);
        if (code != cases[i].code)
            fail_msg("case %zu: %d, %s", i, code, err.message);
        assert_string_equal(err.file, "a.hdr");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_written_and_read), cmocka_unit_test(test_orders),
        cmocka_unit_test(test_exposures),        cmocka_unit_test(test_old_runs),
        cmocka_unit_test(test_without_magic),    cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
