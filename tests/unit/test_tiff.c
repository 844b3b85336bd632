/*
 * TIFF pictures as patterns: samples of every width against the written values, by sRGB or the
 * file's own curve; orientations; transparency; LogLuv; and refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

#include "scene/grid/grid.h"
#include "support/scene_text.h"
#include "support/scratch.h"

enum { W = 5, H = 3 };

/* Properties of a file, besides its pixels. */
struct kind {
    uint16_t bits, format, samples, photometric, orientation, compression;
    bool veiled, curved;
};

static const struct kind usual = {.bits = 8,
                                  .format = SAMPLEFORMAT_UINT,
                                  .samples = 3,
                                  .photometric = PHOTOMETRIC_RGB,
                                  .orientation = ORIENTATION_TOPLEFT,
                                  .compression = COMPRESSION_LZW};

/* Returns a channel's value at a pixel, 0 to 1, unique everywhere. */
static double value_at(int x, int y, int c)
{
    return (1 + x + W * y + 20 * c) / 100.0;
}

static void put_sample(void *row, const struct kind *kind, size_t at, double value)
{
    if (kind->format == SAMPLEFORMAT_IEEEFP)
        ((float *)row)[at] = (float)value;
    else if (kind->bits == 16)
        ((uint16_t *)row)[at] = (uint16_t)lround(value * 65535);
    else
        ((uint8_t *)row)[at] = (uint8_t)lround(value * 255);
}

static void put_fields(TIFF *tiff, const struct kind *kind)
{
    static uint16_t curve[65536]; /* the transfer curve: light is the square */
    const uint16_t veil = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, W);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, H);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind->samples);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind->bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind->format);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kind->photometric);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, kind->orientation);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind->compression);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 2);
    if (kind->compression == COMPRESSION_SGILOG)
        TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
    if (kind->veiled)
        TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &veil);
    for (int i = 0; i < 65536; i++)
        curve[i] = (uint16_t)lround(i / 65535.0 * i);
    if (kind->curved)
        TIFFSetField(tiff, TIFFTAG_TRANSFERFUNCTION, curve, curve, curve);
}

/* Writes a TIFF; with transparency every pixel has an alpha of a half. */
static unsigned char *write_tiff(const struct kind *kind, size_t *ret_size)
{
    TIFF *const tiff = TIFFOpen(scratch_path("a.tif"), "w");
    assert_non_null(tiff);
    put_fields(tiff, kind);
    for (int y = 0; y < H; y++) {
        float row[W * 4];
        for (int x = 0; x < W; x++)
            for (int c = 0; c < kind->samples; c++)
                put_sample(row, kind, (size_t)x * kind->samples + (size_t)c,
                           kind->veiled && c + 1 == kind->samples ? 0.5 : value_at(x, y, c));
        assert_int_equal(TIFFWriteScanline(tiff, row, (uint32_t)y, 0), 1);
    }
    TIFFClose(tiff);
    return scene_read_bytes(scratch_path("a.tif"), ret_size);
}

static struct orl_grid *read_tiff(const struct kind *kind)
{
    struct orl_grid *grid = NULL;
    struct orl_error err = {0};
    size_t size;
    unsigned char *const bytes = write_tiff(kind, &size);
    if (orl_grid_read_picture("a.tif", bytes, size, &grid, &err) < 0)
        fail_msg("%s", err.message);
    free(bytes);
    return grid;
}

static double linear_of_srgb(double v)
{
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double as_it_is(double v)
{
    return v;
}

static double squared(double v)
{
    return v * v;
}

/* Checks every pixel, from the upper left, with `light` as the transfer function; the tolerance is
 * one of values. */
static void expect(const struct kind *kind, double (*light)(double), double part, double tolerance)
{
    struct orl_grid *const grid = read_tiff(kind);
    const bool right = kind->orientation == ORIENTATION_TOPRIGHT;
    const bool bottom = kind->orientation == ORIENTATION_BOTLEFT;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int c = 0; c < 3; c++) {
                const int from = kind->samples < 3 ? 0 : c;
                const double value = value_at(right ? W - 1 - x : x, bottom ? H - 1 - y : y, from);
                const float *const pixel = orl_grid_pixel(grid, (uint32_t)x, (uint32_t)y);
                const double most = light(value + tolerance), least = light(value - tolerance);
                if (!((double)pixel[c] <= part * most && (double)pixel[c] >= part * least))
                    fail_msg("%d %d %d: %g, not %g", x, y, c, (double)pixel[c],
                             part * light(value));
            }
    orl_grid_free(grid);
}

static void test_samples(void **state)
{
    struct kind kind = usual;
    (void)state;
    expect(&kind, linear_of_srgb, 1, 0.51 / 255);
    kind.orientation = ORIENTATION_BOTLEFT;
    expect(&kind, linear_of_srgb, 1, 0.51 / 255);
    kind.bits = 16;
    expect(&kind, linear_of_srgb, 1, 0.51 / 65535);
    kind.orientation = ORIENTATION_TOPRIGHT;
    kind.curved = true;
    expect(&kind, squared, 1, 26.0 / 65535); /* the curve's steps, at a hundredth */
    kind = usual;
    kind.bits = 32;
    kind.format = SAMPLEFORMAT_IEEEFP;
    expect(&kind, as_it_is, 1, 1e-7);
    kind.samples = 1;
    kind.photometric = PHOTOMETRIC_MINISBLACK;
    expect(&kind, as_it_is, 1, 1e-7);
}

/* A pixel of alpha one half is half as bright, over black. */
static void test_veiled(void **state)
{
    struct kind kind = usual;
    (void)state;
    kind.samples = 4;
    kind.veiled = true;
    kind.bits = 32;
    kind.format = SAMPLEFORMAT_IEEEFP;
    expect(&kind, as_it_is, 0.5, 1e-6);
    kind.bits = 16;
    kind.format = SAMPLEFORMAT_UINT;
    expect(&kind, linear_of_srgb, 0.5, 2.0 / 65535);
}

/* Steps of luminance are 0.27 % in LogLuv; a uniform colour is grey, with equal XYZ. */
static void test_logluv(void **state)
{
    struct kind kind = usual;
    (void)state;
    kind.bits = 32;
    kind.format = SAMPLEFORMAT_IEEEFP;
    kind.compression = COMPRESSION_SGILOG;
    kind.photometric = PHOTOMETRIC_LOGL;
    kind.samples = 1;
    expect(&kind, as_it_is, 1, 0.0015);
    kind.photometric = PHOTOMETRIC_LOGLUV;
    kind.samples = 3;
    struct orl_grid *const grid = read_tiff(&kind);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const float *const rgb = orl_grid_pixel(grid, (uint32_t)x, (uint32_t)y);
            const double luma =
                0.265 * (double)rgb[0] + 0.670 * (double)rgb[1] + 0.065 * (double)rgb[2];
            assert_true(fabs(luma - value_at(x, y, 1)) < 0.01 * value_at(x, y, 1));
            assert_true(rgb[2] > rgb[0]); /* Z is above X */
        }
    orl_grid_free(grid);
}

static int code_of(const unsigned char *bytes, size_t size)
{
    struct orl_grid *grid = NULL;
    struct orl_error err = {0};
    const int code = orl_grid_read_picture("a.tif", bytes, size, &grid, &err);
    if (code < 0) {
        assert_string_equal(err.file, "a.tif");
        assert_true(err.message[0] != '\0');
    }
    orl_grid_free(grid);
    return code;
}

/* A file cut or overwritten anywhere is read, or refused with a reason. */
static void test_damaged(void **state)
{
    struct kind kind = usual;
    size_t size, refused = 0;
    (void)state;
    kind.bits = 16;
    unsigned char *const bytes = write_tiff(&kind, &size);
    assert_int_equal(code_of(bytes, size), 0);
    for (size_t cut = 4; cut < size; cut += 3)
        refused += code_of(bytes, cut) < 0;
    assert_true(refused > 0);
    for (size_t at = 4; at < size; at++) {
        bytes[at] ^= 0x55;
        (void)code_of(bytes, size);
        bytes[at] ^= 0x55;
    }
    free(bytes);
}

/* Rotated pictures, and non-finite values, are refused. */
static void test_refused(void **state)
{
    struct kind kind = usual;
    float nan_row[W * 3];
    size_t size;
    (void)state;
    unsigned char *bytes;
    for (int floats = 0; floats < 2; floats++) {
        kind.bits = floats ? 32 : 8;
        kind.format = floats ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT;
        kind.orientation = ORIENTATION_LEFTTOP;
        bytes = write_tiff(&kind, &size);
        assert_int_equal(code_of(bytes, size), ORL_ERR_UNSUPPORTED);
        free(bytes);
    }
    kind.orientation = ORIENTATION_TOPLEFT;
    TIFF *const tiff = TIFFOpen(scratch_path("nan.tif"), "w");
    put_fields(tiff, &kind);
    for (int i = 0; i < W * 3; i++)
        nan_row[i] = NAN;
    for (uint32_t y = 0; y < H; y++)
        assert_int_equal(TIFFWriteScanline(tiff, nan_row, y, 0), 1);
    TIFFClose(tiff);
    bytes = scene_read_bytes(scratch_path("nan.tif"), &size);
    assert_int_equal(code_of(bytes, size), ORL_ERR_RANGE);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples), cmocka_unit_test(test_veiled),
        cmocka_unit_test(test_logluv),  cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
