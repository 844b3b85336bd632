/*
 * TIFF by libtiff. Floats are used unchanged; LogLuv (Ward, "LogLuv Encoding for Full-Gamut,
 * High-Dynamic Range Images", 1998) is decoded to XYZ. 16-bit integers become linear light by the
 * file's TransferFunction, or by sRGB. Other kinds are read as libtiff converts them to 8 bits, by
 * sRGB. Transparent pixels are composited over black.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

#include "scene/grid/grid.h"
#include "scene/material/patterns/observer.h"

enum { WORDS = 160, MOST_SAMPLES = 8, LEVELS_16 = 65536 };

/* A file in memory, the library's position in it, and its first error message. */
struct reading {
    const char *name;
    const unsigned char *data;
    size_t size;
    uint64_t at;
    char words[WORDS];
    TIFF *tiff;
    struct orl_grid *grid;
    uint32_t width, height;
    uint16_t samples, bits, format, photometric, orientation;
};

static int fail(const struct reading *r, int code, struct orl_error *err, const char *what)
{
    char text[2 * WORDS];
    snprintf(text, sizeof text, "%s: %s", what, r->words);
    return orl_grid_fail(r->name, code, err, code == ORL_ERR_SYNTAX && r->words[0] ? text : what);
}

static int refuse_kind(const struct reading *r, struct orl_error *err, const char *what)
{
    fail(r, ORL_ERR_UNSUPPORTED, err, what);
    orl_error_hint(err, "save it upright, with 8 or 16 bits a channel, or as floats");
    return ORL_ERR_UNSUPPORTED;
}

/* ---- The file -------------------------------------------------------------------------------- */

static tmsize_t read_bytes(thandle_t ctx, void *buffer, tmsize_t size)
{
    struct reading *const r = ctx;
    if (size <= 0 || r->at >= r->size)
        return 0;
    const uint64_t left = r->size - r->at, n = (uint64_t)size < left ? (uint64_t)size : left;
    memcpy(buffer, r->data + r->at, n);
    r->at += n;
    return (tmsize_t)n;
}

static tmsize_t write_bytes(thandle_t ctx, void *buffer, tmsize_t size)
{
    (void)ctx, (void)buffer, (void)size;
    return 0;
}

static toff_t seek(thandle_t ctx, toff_t offset, int whence)
{
    struct reading *const r = ctx;
    r->at = offset + (whence == SEEK_CUR ? r->at : whence == SEEK_END ? r->size : 0);
    return r->at;
}

static int close_file(thandle_t ctx)
{
    (void)ctx;
    return 0;
}

static toff_t ask_size(thandle_t ctx)
{
    return ((const struct reading *)ctx)->size;
}

static int map_file(thandle_t ctx, void **ret_base, toff_t *ret_size)
{
    const struct reading *const r = ctx;
    *ret_base = (void *)(uintptr_t)r->data; /* libtiff only reads it */
    *ret_size = r->size;
    return 1;
}

static void unmap_file(thandle_t ctx, void *base, toff_t size)
{
    (void)ctx, (void)base, (void)size;
}

/* Stores the library's first message. */
__attribute__((format(printf, 4, 0))) static int
keep_message(TIFF *tiff, void *ctx, const char *module, const char *format, va_list arguments)
{
    struct reading *const r = ctx;
    (void)tiff, (void)module;
    if (r->words[0] == '\0')
        vsnprintf(r->words, WORDS, format, arguments);
    return 1;
}

__attribute__((format(printf, 4, 0))) static int
discard_message(TIFF *tiff, void *ctx, const char *module, const char *format, va_list arguments)
{
    (void)tiff, (void)ctx, (void)module, (void)format, (void)arguments;
    return 1;
}

static int open_tiff(struct reading *r, struct orl_error *err)
{
    TIFFOpenOptions *const options = TIFFOpenOptionsAlloc();
    if (!options)
        return fail(r, ORL_ERR_NOMEM, err, "out of memory for a picture");
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, ORL_GRID_VALUES * sizeof(float));
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, r);
    TIFFOpenOptionsSetWarningHandlerExtR(options, discard_message, r);
    r->tiff = TIFFClientOpenExt(r->name, "rm", r, read_bytes, write_bytes, seek, close_file,
                                ask_size, map_file, unmap_file, options);
    TIFFOpenOptionsFree(options);
    return r->tiff ? 0 : fail(r, ORL_ERR_SYNTAX, err, "the TIFF is damaged");
}

/* ---- Header ---------------------------------------------------------------------------------- */

static int read_header(struct reading *r, struct orl_error *err)
{
    float across = 0, down = 0;
    r->photometric = PHOTOMETRIC_MINISBLACK;
    if (!TIFFGetField(r->tiff, TIFFTAG_IMAGEWIDTH, &r->width) ||
        !TIFFGetField(r->tiff, TIFFTAG_IMAGELENGTH, &r->height))
        return fail(r, ORL_ERR_SYNTAX, err, "the TIFF has no size");
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_SAMPLESPERPIXEL, &r->samples);
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_BITSPERSAMPLE, &r->bits);
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_SAMPLEFORMAT, &r->format);
    TIFFGetField(r->tiff, TIFFTAG_PHOTOMETRIC, &r->photometric);
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_ORIENTATION, &r->orientation);
    if (r->orientation > ORIENTATION_BOTLEFT)
        return refuse_kind(r, err, "the TIFF is rotated by 90 degrees");
    TIFFGetField(r->tiff, TIFFTAG_XRESOLUTION, &across);
    TIFFGetField(r->tiff, TIFFTAG_YRESOLUTION, &down);
    const double aspect = across > 0 && down > 0 ? (double)across / (double)down : 1;
    return orl_grid_new_picture(r->name, r->width, r->height,
                                aspect > 1e-3 && aspect < 1e3 ? aspect : 1, &r->grid, err);
}

static bool is_logluv(const struct reading *r)
{
    return r->photometric == PHOTOMETRIC_LOGLUV || r->photometric == PHOTOMETRIC_LOGL;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/* Conversion of 16-bit or 32-bit samples to light. */
struct converter {
    float *of_16;     /* light by 16-bit value; NULL: samples are floats */
    bool is_xyz;      /* LogLuv */
    uint16_t colours; /* 1: grey; 3: colour */
    bool veiled;      /* an alpha sample follows the colours */
};

static float *make_table(const struct reading *r)
{
    uint16_t *curve = NULL, *second = NULL, *third = NULL;
    float *const table = malloc(LEVELS_16 * sizeof *table);
    const bool told = TIFFGetField(r->tiff, TIFFTAG_TRANSFERFUNCTION, &curve, &second, &third) == 1;
    for (int i = 0; table && i < LEVELS_16; i++) {
        const int value = r->photometric == PHOTOMETRIC_MINISWHITE ? LEVELS_16 - 1 - i : i;
        table[i] =
            (float)(told && curve ? curve[value] / 65535.0 : orl_linear_of_srgb(value / 65535.0));
    }
    return table;
}

static float sample_at(const struct converter *c, const void *row, size_t at)
{
    return c->of_16 ? c->of_16[((const uint16_t *)row)[at]] : ((const float *)row)[at];
}

static void take_pixel(const struct reading *r, const struct converter *c, const void *row,
                       uint32_t x, float *rgb)
{
    const size_t first = (size_t)x * r->samples;
    for (size_t i = 0; i < ORL_GRID_CHANNELS; i++)
        rgb[i] = sample_at(c, row, first + (c->colours == 1 ? 0 : i));
    if (c->is_xyz && c->colours == 3) {
        const struct orl_rgb seen = orl_tristimulus_rgb(
            (struct orl_tristimulus){(double)rgb[0], (double)rgb[1], (double)rgb[2]});
        rgb[0] = (float)seen.r;
        rgb[1] = (float)seen.g;
        rgb[2] = (float)seen.b;
    }
    if (!c->veiled)
        return;
    const float there = c->of_16 ? (float)(((const uint16_t *)row)[first + c->colours] / 65535.0)
                                 : sample_at(c, row, first + c->colours);
    for (size_t i = 0; i < ORL_GRID_CHANNELS; i++)
        rgb[i] *= there;
}

/* Reads all rows; flips those stored from the right or from the bottom. */
static int read_rows(struct reading *r, const struct converter *c, struct orl_error *err)
{
    const uint16_t o = r->orientation;
    const bool right = o == ORIENTATION_TOPRIGHT || o == ORIENTATION_BOTRIGHT;
    const bool bottom = o == ORIENTATION_BOTLEFT || o == ORIENTATION_BOTRIGHT;
    const size_t bytes = (size_t)r->width * r->samples * (c->of_16 ? 2 : 4);
    void *const row = (size_t)TIFFScanlineSize(r->tiff) == bytes ? malloc(bytes) : NULL;
    if (!row)
        return fail(r, ORL_ERR_SYNTAX, err, "the TIFF's rows do not have the stated length");
    int code = 0;
    for (uint32_t y = 0; y < r->height && code == 0; y++) {
        const uint32_t to = bottom ? r->height - 1 - y : y;
        if (TIFFReadScanline(r->tiff, row, y, 0) != 1)
            code = fail(r, ORL_ERR_SYNTAX, err, "the TIFF is damaged");
        for (uint32_t x = 0; x < r->width && code == 0; x++)
            take_pixel(r, c, row, x, orl_grid_pixel(r->grid, right ? r->width - 1 - x : x, to));
    }
    free(row);
    return code;
}

/* Returns true if the pixels have an unassociated (not premultiplied) alpha sample. */
static bool is_veiled(const struct reading *r, uint16_t colours)
{
    uint16_t n = 0, *kinds = NULL;
    return TIFFGetField(r->tiff, TIFFTAG_EXTRASAMPLES, &n, &kinds) == 1 && n > 0 &&
           kinds[0] == EXTRASAMPLE_UNASSALPHA && r->samples > colours;
}

/* Reads 16-bit or float samples, pixel by pixel. */
static int read_wide(struct reading *r, struct orl_error *err)
{
    const bool floats = r->bits == 32;
    uint16_t planes = PLANARCONFIG_CONTIG;
    struct converter c = {.is_xyz = is_logluv(r), .colours = r->samples >= 3 ? 3 : 1};
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_PLANARCONFIG, &planes);
    if (TIFFIsTiled(r->tiff) || (planes != PLANARCONFIG_CONTIG && r->samples > 1) ||
        r->samples > MOST_SAMPLES) {
        fail(r, ORL_ERR_UNSUPPORTED, err,
             "TIFFs of 16 bits or floats must store strips of whole pixels");
        orl_error_hint(err, "convert it with tiffcp -s -p contig");
        return ORL_ERR_UNSUPPORTED;
    }
    c.veiled = is_veiled(r, c.colours);
    c.of_16 = floats ? NULL : make_table(r);
    if (!floats && !c.of_16)
        return fail(r, ORL_ERR_NOMEM, err, "out of memory for a picture");
    const int code = read_rows(r, &c, err);
    free(c.of_16);
    return code;
}

/* Reads the picture through libtiff's 8-bit RGBA, whose colours are premultiplied by alpha. */
static int read_shown(struct reading *r, struct orl_error *err)
{
    const size_t n = (size_t)r->width * r->height;
    char why[1024] = "";
    float decoded[256];
    if (r->format == SAMPLEFORMAT_INT || !TIFFRGBAImageOK(r->tiff, why))
        return refuse_kind(r, err, "this kind of TIFF is not supported");
    uint32_t *const pixels = malloc(n * sizeof *pixels);
    if (!pixels)
        return fail(r, ORL_ERR_NOMEM, err, "out of memory for a picture");
    if (!TIFFReadRGBAImageOriented(r->tiff, r->width, r->height, pixels, ORIENTATION_TOPLEFT, 1)) {
        free(pixels);
        return fail(r, ORL_ERR_SYNTAX, err, "the TIFF is damaged");
    }
    orl_linear_of_srgb_bytes(decoded);
    for (size_t i = 0; i < n; i++) {
        float *const rgb =
            orl_grid_pixel(r->grid, (uint32_t)(i % r->width), (uint32_t)(i / r->width));
        rgb[0] = decoded[TIFFGetR(pixels[i])];
        rgb[1] = decoded[TIFFGetG(pixels[i])];
        rgb[2] = decoded[TIFFGetB(pixels[i])];
    }
    free(pixels);
    return 0;
}

static int read_pixels(struct reading *r, struct orl_error *err)
{
    if (is_logluv(r) && TIFFSetField(r->tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT)) {
        r->bits = 32;
        return read_wide(r, err);
    }
    const bool whole = r->bits == 16 && r->format == SAMPLEFORMAT_UINT;
    const bool floats = r->bits == 32 && r->format == SAMPLEFORMAT_IEEEFP;
    const bool plain =
        r->photometric == PHOTOMETRIC_MINISBLACK || r->photometric == PHOTOMETRIC_RGB;
    if ((whole && r->photometric == PHOTOMETRIC_MINISWHITE) || ((whole || floats) && plain))
        return read_wide(r, err);
    return read_shown(r, err);
}

static int check_values(const struct reading *r, struct orl_error *err)
{
    for (size_t i = 0; i < r->grid->n_values; i++)
        if (!isfinite(r->grid->values[i]))
            return fail(r, ORL_ERR_RANGE, err, "the TIFF has a value that is not finite");
    return 0;
}

int orl_grid_read_tiff(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                       struct orl_error *err)
{
    struct reading r = {.name = name, .data = data, .size = size};
    int code = open_tiff(&r, err);
    if (code < 0)
        return code;
    code = read_header(&r, err);
    if (code == 0)
        code = read_pixels(&r, err);
    if (code == 0)
        code = check_values(&r, err);
    TIFFClose(r.tiff);
    if (code < 0)
        orl_grid_free(r.grid);
    else
        *ret_grid = r.grid;
    return code;
}
