/*
 * Image files: RGBE of known values, HDR files read by a decoder of the test's own, OpenEXR by its
 * library.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <OpenEXR/openexr.h>
#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "render/film/film.h"
#include "render/film/image_files.h"
#include "support/scene_text.h"
#include "support/scratch.h"

/* ---- RGBE -------------------------------------------------------------------------------------
 */

static void test_rgbe(void **state)
{
    static const struct {
        float rgb[3];
        unsigned char rgbe[4];
    } known[] = {{{1, 1, 1}, {128, 128, 128, 129}},
                 {{0, 0, 0}, {0, 0, 0, 0}},
                 {{0.5F, 0.25F, 0}, {128, 64, 0, 128}},
                 {{1000, 1, 0.1F}, {250, 0, 0, 138}},
                 {{1e-33F, 0, 0}, {0, 0, 0, 0}},
                 {{NAN, 1, 1}, {0, 128, 128, 129}},
                 {{INFINITY, 1, -INFINITY}, {0, 128, 0, 129}},
                 {{-5, 2, 1}, {0, 128, 64, 130}},
                 {{0.9999999F, 0, 0}, {255, 0, 0, 128}}};
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        unsigned char rgbe[4];
        orl_rgbe_encode(known[i].rgb, rgbe);
        assert_memory_equal(rgbe, known[i].rgbe, 4);
    }
}

/* ---- A decoder of Radiance pictures -----------------------------------------------------------
 */

/* The header's lines, and the raw pixels: bytes of RGBE. */
struct picture {
    char view[1200], aspect[64];
    bool has_format;
    unsigned width, height;
    unsigned char (*rgbe)[4];
};

/* Reads one line without its end; fails at the end of the bytes. */
static void take_line(const unsigned char **at, const unsigned char *end, char *line, size_t size)
{
    size_t n = 0;
    while (*at < end && **at != '\n') {
        assert_true(n + 1 < size);
        line[n++] = (char)*(*at)++;
    }
    assert_true(*at < end);
    (*at)++;
    line[n] = '\0';
}

/* Decodes a scanline of four components, each in runs (over 128: repeat one byte) and literals. */
static const unsigned char *take_rle(const unsigned char *at, const unsigned char *end,
                                     unsigned width, unsigned char (*row)[4])
{
    assert_true(end - at >= 4 && at[0] == 2 && at[1] == 2);
    assert_int_equal(at[2] << 8 | at[3], width);
    at += 4;
    for (int c = 0; c < 4; c++) {
        for (unsigned x = 0; x < width;) {
            assert_true(end - at >= 2);
            const bool run = at[0] > 128;
            const unsigned count = run ? at[0] - 128U : at[0];
            at++;
            assert_true(count > 0 && x + count <= width && end - at >= (run ? 1 : (int)count));
            for (unsigned i = 0; i < count; i++)
                row[x++][c] = run ? *at : at[i];
            at += run ? 1 : count;
        }
    }
    return at;
}

static struct picture read_picture(const char *path)
{
    struct picture p = {.width = 0};
    size_t size;
    unsigned char *bytes = scene_read_bytes(path, &size);
    const unsigned char *at = bytes, *end = bytes + size;
    char line[1200];
    take_line(&at, end, line, sizeof line);
    assert_string_equal(line, "#?RADIANCE");
    for (take_line(&at, end, line, sizeof line); line[0]; take_line(&at, end, line, sizeof line)) {
        if (strncmp(line, "VIEW=", 5) == 0)
            snprintf(p.view, sizeof p.view, "%s", line + 5);
        if (strncmp(line, "PIXASPECT=", 10) == 0)
            snprintf(p.aspect, sizeof p.aspect, "%.63s", line + 10);
        p.has_format = p.has_format || strcmp(line, "FORMAT=32-bit_rle_rgbe") == 0;
        assert_null(strstr(line, "EXPOSURE"));
    }
    take_line(&at, end, line, sizeof line);
    assert_int_equal(sscanf(line, "-Y %u +X %u", &p.height, &p.width), 2);
    p.rgbe = malloc((size_t)p.width * p.height * sizeof *p.rgbe);
    assert_non_null(p.rgbe);
    for (unsigned y = 0; y < p.height; y++) {
        unsigned char(*row)[4] = p.rgbe + (size_t)y * p.width;
        if (p.width >= 8 && p.width < 32768) {
            at = take_rle(at, end, p.width, row);
        } else {
            assert_true(end - at >= 4 * (long)p.width);
            memcpy(row, at, 4 * (size_t)p.width);
            at += 4 * (size_t)p.width;
        }
    }
    assert_ptr_equal(at, end);
    free(bytes);
    return p;
}

/* ---- HDR files --------------------------------------------------------------------------------
 */

static struct orl_view some_view(void)
{
    struct orl_view view;
    assert_int_equal(orl_view_parse("-vta -vp 1 2 3 -vd 1 0 0 -vh 180 -vv 180", &view, NULL), 0);
    return view;
}

/* Returns pixel values of a kind: noise, long runs, one value, runs of every length. */
static float pixel_value(int kind, unsigned x, unsigned y, int c, struct orl_random *random)
{
    switch (kind) {
    case 0:
        return (float)exp(20 * orl_random_uniform(random) - 10);
    case 1:
        return (float)((x / 200 + y) % 3 + (unsigned)c);
    case 2:
        return 0.7F;
    default: {
        /* Run n is n pixels long: 1 + 2 + ... */
        const unsigned run = (unsigned)((sqrt(8.0 * x + 1) - 1) / 2);
        return run % 2 ? 3.5F : 1e-3F;
    }
    }
}

static void check_size(unsigned width, unsigned height, int kind)
{
    const struct orl_view view = some_view();
    struct orl_random random = orl_random_stream(width, ORL_PURPOSE_BENCH, (uint64_t)kind);
    struct orl_film film;
    assert_int_equal(orl_film_init(&film, width, height, NULL), 0);
    for (unsigned i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = pixel_value(kind, i % width, i / width, c, &random);
    assert_int_equal(orl_film_write_hdr(&film, &view, scratch_path("a.hdr"), NULL), 0);
    struct picture p = read_picture(scratch_path("a.hdr"));
    assert_int_equal(p.width, width);
    assert_int_equal(p.height, height);
    for (unsigned i = 0; i < width * height; i++) {
        const double scale = ldexp(1, p.rgbe[i][3] - 136);
        const double most = fmax(film.pixels[i][0], fmax(film.pixels[i][1], film.pixels[i][2]));
        /* The error is half a step, and a step is 1/256 of the next power of two above the
         * maximum: half of 1/128. */
        for (int c = 0; c < 3; c++)
            assert_true(fabs((p.rgbe[i][c] + 0.5) * scale - film.pixels[i][c]) <= most / 256);
    }
    free(p.rgbe);
    orl_film_done(&film);
}

static void test_hdr_sizes(void **state)
{
    static const unsigned widths[] = {1, 5, 7, 8, 300, 32767, 32768, 40000};
    (void)state;
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
        for (int kind = 0; kind < 4; kind++)
            check_size(widths[w], widths[w] > 1000 ? 2 : 11, kind);
}

static void test_hdr_header(void **state)
{
    const struct orl_view view = some_view();
    struct orl_film film;
    char text[1024];
    (void)state;
    assert_int_equal(orl_film_init(&film, 16, 16, NULL), 0);
    assert_int_equal(orl_film_write_hdr(&film, &view, scratch_path("b.hdr"), NULL), 0);
    struct picture p = read_picture(scratch_path("b.hdr"));
    orl_view_format(&view, text, sizeof text);
    assert_true(p.has_format);
    assert_non_null(strstr(p.view, text));
    assert_non_null(strstr(p.view, "-vta "));
    assert_string_equal(p.aspect, ""); /* square pixels */
    for (int i = 0; i < 256; i++)
        assert_memory_equal(p.rgbe[i], "\0\0\0\0", 4);
    free(p.rgbe);
    orl_film_done(&film);
    /* The temporary .part file is gone. */
    assert_int_equal(access(scratch_path("b.hdr.part"), F_OK), -1);
}

/* Pixels twice as high as wide have their aspect, height over width, in the header. */
static void test_pixel_aspect(void **state)
{
    const struct orl_view view = some_view();
    struct orl_film film;
    double aspect = 0;
    (void)state;
    assert_int_equal(orl_film_init(&film, 20, 10, NULL), 0);
    assert_int_equal(orl_film_write_hdr(&film, &view, scratch_path("c.hdr"), NULL), 0);
    struct picture p = read_picture(scratch_path("c.hdr"));
    assert_int_equal(sscanf(p.aspect, "%lf", &aspect), 1);
    assert_true(fabs(aspect - 2) < 1e-5);
    free(p.rgbe);
    orl_film_done(&film);
}

/* ---- PNG --------------------------------------------------------------------------------------
 */

/* OpenEXR: halves and floats and the view's attributes, read by its own library. */
static void read_exr(const char *path, const struct orl_film *film, bool halves)
{
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    const exr_attr_chlist_entry_t *first;
    const exr_attr_chlist_t *channels;
    exr_context_t exr;
    exr_attr_m44f_t camera;
    exr_attr_chromaticities_t primaries;
    float nits;
    assert_int_equal(exr_start_read(&exr, path, &how), 0);
    assert_int_equal(exr_get_channels(exr, 0, &channels), 0);
    first = channels->entries;
    assert_int_equal(channels->num_channels, 3);
    assert_int_equal(first->pixel_type, halves ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT);
    assert_int_equal(exr_attr_get_float(exr, 0, "whiteLuminance", &nits), 0);
    assert_true(nits == 179);
    assert_int_equal(exr_attr_get_chromaticities(exr, 0, "chromaticities", &primaries), 0);
    assert_true(primaries.red_x == 0.640F && primaries.green_y == 0.600F &&
                primaries.blue_x == 0.150F && primaries.white_x == 1 / 3.0F);
    assert_int_equal(exr_attr_get_m44f(exr, 0, "worldToCamera", &camera), 0);
    /* some_view is from (1, 2, 3) along x; the point is 5 ahead of it, 1 to the right and 2 up. */
    const float point[4] = {6, 1, 5, 1}, expected[3] = {1, 2, -5};
    for (int c = 0; c < 3; c++) {
        float sum = 0;
        for (int r = 0; r < 4; r++)
            sum += point[r] * camera.m[4 * r + c];
        assert_true(fabsf(sum - expected[c]) < 1e-5F);
    }
    float *read = calloc(3 * (size_t)film->width * film->height, sizeof *read);
    for (uint32_t y = 0; y < film->height; y += 16) {
        exr_chunk_info_t chunk;
        assert_int_equal(exr_read_scanline_chunk_info(exr, 0, (int)y, &chunk), 0);
        assert_int_equal(y == 0 ? exr_decoding_initialize(exr, 0, &chunk, &pipeline)
                                : exr_decoding_update(exr, 0, &chunk, &pipeline),
                         0);
        for (int c = 0; c < 3; c++) {
            pipeline.channels[c].decode_to_ptr =
                (uint8_t *)(read + 3 * (size_t)y * film->width + 2 - c);
            pipeline.channels[c].user_pixel_stride = 12;
            pipeline.channels[c].user_line_stride = (int32_t)(12 * film->width);
            pipeline.channels[c].user_bytes_per_element = 4;
            pipeline.channels[c].user_data_type = EXR_PIXEL_FLOAT;
        }
        assert_int_equal(exr_decoding_choose_default_routines(exr, 0, &pipeline), 0);
        assert_int_equal(exr_decoding_run(exr, 0, &pipeline), 0);
    }
    for (size_t i = 0; i < 3 * (size_t)film->width * film->height; i++) {
        const float value = film->pixels[i / 3][i % 3], held = halves ? fminf(value, 65504) : value;
        assert_true(fabsf(read[i] - held) <= (halves ? 4.9e-4F * held + 3e-8F : 0));
    }
    free(read);
    exr_decoding_destroy(exr, &pipeline);
    exr_finish(&exr);
}

static void test_exr(void **state)
{
    const struct orl_view view = some_view();
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_film film;
    (void)state;
    assert_int_equal(orl_film_init(&film, 37, 41, NULL), 0);
    for (size_t i = 0; i < 3 * 37 * 41; i++)
        film.pixels[i / 3][i % 3] = (float)exp(30 * orl_random_uniform(&random) - 14);
    for (int halves = 0; halves < 2; halves++) {
        assert_int_equal(orl_exr_write(&film, &view, halves, scratch_path("a.exr"), NULL), 0);
        read_exr(scratch_path("a.exr"), &film, halves);
    }
    struct orl_error err;
    assert_int_equal(orl_exr_write(&film, &view, true, scratch_path("no/a.exr"), &err), ORL_ERR_IO);
    orl_film_done(&film);
}

static void test_unwritable(void **state)
{
    const struct orl_view view = some_view();
    struct orl_film film;
    struct orl_error err;
    (void)state;
    assert_int_equal(orl_film_init(&film, 2, 2, NULL), 0);
    assert_int_equal(orl_film_write_hdr(&film, &view, scratch_path("no/a.hdr"), &err), ORL_ERR_IO);
    orl_film_done(&film);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rgbe),       cmocka_unit_test(test_hdr_sizes),
        cmocka_unit_test(test_hdr_header), cmocka_unit_test(test_pixel_aspect),
        cmocka_unit_test(test_exr),        cmocka_unit_test(test_unwritable),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
