/* Views under several skies: a common exposure, the contact sheet, the animation's chunks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <expat.h>
#include <oriel/job/picture.h>
#include <png.h>
#include <zlib.h>

#include "base/sampling/sampling.h"
#include "chart/charts.h"
#include "render/film/film.h"
#include "render/film/image_files.h"
#include "render/picture/display.h"
#include "support/cli.h"
#include "support/scene_text.h"

static char folder[64];

static int set_up(void **state)
{
    (void)state;
    cli_make_folder(folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    cli_remove_folder(folder);
    return 0;
}

static char *path_of(const char *name, char ret_path[128])
{
    snprintf(ret_path, 128, "%s/%s", folder, name);
    return ret_path;
}

/* ---- A decoder of animations ----------------------------------------------------------------- */

/* The decoded animation; chunks are checked while they are read. */
struct animation {
    uint32_t width, height, frames, plays, controls, numbered;
    unsigned delay, per_second;
    unsigned char *coded; /* data of the current frame; owned */
    size_t coded_size;
    unsigned char *pixels; /* pixels of all frames so far; owned */
    uint32_t read;
    unsigned char *poster; /* the still PNG image; NULL: the first frame; owned */
};

static uint32_t number_at(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* Inverts Paeth's filter, as the PNG specification defines it. */
static unsigned char paeth(int a, int b, int c)
{
    const int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    if (pa <= pb && pa <= pc)
        return (unsigned char)a;
    return (unsigned char)(pb <= pc ? b : c);
}

static void end_frame(struct animation *a)
{
    const size_t row = 3 * (size_t)a->width, all = (row + 1) * a->height;
    uLongf size = all;
    if (a->coded_size == 0)
        return;
    if (a->controls == 0)
        a->poster = malloc(row * a->height);
    unsigned char *plain = malloc(all);
    unsigned char *out = a->controls > 0 ? a->pixels + a->read * row * a->height : a->poster;
    assert_int_equal(uncompress(plain, &size, a->coded, a->coded_size), Z_OK);
    assert_int_equal(size, all);
    for (uint32_t y = 0; y < a->height; y++) {
        const unsigned char *in = plain + (row + 1) * y;
        unsigned char *line = out + row * y;
        assert_int_equal(in[0], 4);
        for (size_t x = 0; x < row; x++) {
            const int left = x < 3 ? 0 : line[x - 3], above = y == 0 ? 0 : line[x - row];
            const int corner = x < 3 || y == 0 ? 0 : line[x - row - 3];
            line[x] = (unsigned char)(in[1 + x] + paeth(left, above, corner));
        }
    }
    free(plain);
    a->coded_size = 0;
    a->read += a->controls > 0;
}

static void take_data(struct animation *a, const unsigned char *data, size_t size)
{
    a->coded = realloc(a->coded, a->coded_size + size + 1);
    memcpy(a->coded + a->coded_size, data, size);
    a->coded_size += size;
}

static void take_chunk(struct animation *a, const char *type, const unsigned char *data,
                       size_t size)
{
    if (strcmp(type, "IHDR") == 0) {
        a->width = number_at(data);
        a->height = number_at(data + 4);
        assert_memory_equal(data + 8, "\x08\x02\x00\x00\x00", 5);
    } else if (strcmp(type, "acTL") == 0) {
        a->frames = number_at(data);
        a->plays = number_at(data + 4);
        a->pixels = malloc(3 * (size_t)a->width * a->height * a->frames);
    } else if (strcmp(type, "fcTL") == 0) {
        end_frame(a);
        assert_int_equal(number_at(data), a->numbered++);
        assert_int_equal(number_at(data + 4), a->width);
        assert_int_equal(number_at(data + 8), a->height);
        a->delay = (unsigned)data[20] << 8 | data[21];
        a->per_second = (unsigned)data[22] << 8 | data[23];
        a->controls++;
    } else if (strcmp(type, "fdAT") == 0) {
        assert_true(a->controls > (a->poster ? 0U : 1U));
        assert_int_equal(number_at(data), a->numbered++);
        take_data(a, data + 4, size - 4);
    } else if (strcmp(type, "IDAT") == 0) {
        assert_in_range(a->controls, 0, a->poster ? 0 : 1);
        take_data(a, data, size);
    }
}

static struct animation read_animation(const char *path)
{
    struct animation a = {.width = 0};
    size_t size;
    unsigned char *bytes = scene_read_bytes(path, &size);
    bool ended = false;
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    for (size_t at = 8; at < size;) {
        const size_t length = number_at(bytes + at);
        char type[5] = "";
        memcpy(type, bytes + at + 4, 4);
        assert_true(!ended && at + 12 + length <= size);
        assert_int_equal(crc32(0, bytes + at + 4, (uInt)(length + 4)),
                         number_at(bytes + at + 8 + length));
        ended = strcmp(type, "IEND") == 0;
        take_chunk(&a, type, bytes + at + 8, length);
        at += 12 + length;
    }
    assert_true(ended);
    end_frame(&a);
    free(bytes);
    return a;
}

static void animation_done(struct animation *a)
{
    free(a->coded);
    free(a->pixels);
    free(a->poster);
}

/* Noise, which is coded into many chunks, and flat frames. */
static void test_animation_is_read_back(void **state)
{
    enum { WIDTH = 301, HEIGHT = 203, FRAMES = 3 };
    const size_t bytes = 3 * (size_t)WIDTH * HEIGHT;
    unsigned char *rgb = malloc(FRAMES * bytes);
    struct orl_apng *apng;
    char path[128];
    (void)state;
    for (size_t i = 0; i < FRAMES * bytes; i++)
        rgb[i] = i < bytes ? 200 : (unsigned char)orl_mix64(i);
    path_of("a.png", path);
    assert_int_equal(orl_apng_open(path, WIDTH, HEIGHT, FRAMES, 0.25, &apng, NULL), 0);
    for (int i = 0; i < FRAMES; i++)
        assert_int_equal(orl_apng_add(apng, rgb + (size_t)i * bytes, NULL), 0);
    assert_int_equal(orl_apng_add(apng, rgb, NULL), ORL_ERR_INTERNAL);
    assert_int_equal(orl_apng_close(apng, 0, NULL), 0);
    struct animation a = read_animation(path);
    assert_int_equal(a.width, WIDTH);
    assert_int_equal(a.frames, FRAMES);
    assert_int_equal(a.controls, FRAMES);
    assert_int_equal(a.read, FRAMES);
    assert_int_equal(a.plays, 0);
    assert_int_equal(a.delay * 4, a.per_second);
    assert_true(a.numbered > 2 * FRAMES);
    assert_memory_equal(a.pixels, rgb, FRAMES * bytes);
    animation_done(&a);
    free(rgb);
}

/* An unfinished animation leaves no file. */
static void test_animation_is_whole_or_absent(void **state)
{
    const unsigned char rgb[3] = {1, 2, 3};
    struct orl_apng *apng;
    struct orl_error err = {0};
    char path[128], part[140];
    (void)state;
    path_of("b.png", path);
    assert_int_equal(orl_apng_open(path, 1, 1, 2, 1, &apng, NULL), 0);
    assert_int_equal(orl_apng_add(apng, rgb, NULL), 0);
    assert_int_equal(orl_apng_close(apng, 0, &err), ORL_ERR_INTERNAL);
    snprintf(part, sizeof part, "%s.part", path);
    assert_true(!fopen(path, "r") && !fopen(part, "r"));
    assert_int_equal(orl_apng_close(NULL, ORL_ERR_RANGE, NULL), ORL_ERR_RANGE);
}

/* ---- Common exposure ------------------------------------------------------------------------- */

enum { SIDE = 64 };

/* Writes a ramp of radiance over columns, from `darkest` at the left to a thousand times that at
 * the right. */
static void write_ramp(const char *name, double darkest, uint32_t width)
{
    struct orl_film film;
    struct orl_view view;
    char path[128];
    assert_int_equal(orl_film_init(&film, width, SIDE, NULL), 0);
    assert_int_equal(orl_view_parse("-vtv -vd 0 1 0 -vh 60 -vv 60", &view, NULL), 0);
    for (uint32_t i = 0; i < width * SIDE; i++)
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = (float)(darkest * pow(1000, (double)(i % width) / width));
    assert_int_equal(orl_film_write_hdr(&film, &view, path_of(name, path), NULL), 0);
    orl_film_done(&film);
}

static unsigned char *read_png(const char *name, png_image *image)
{
    char path[128];
    memset(image, 0, sizeof *image);
    image->version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(image, path_of(name, path)));
    image->format = PNG_FORMAT_RGB;
    unsigned char *rgb = malloc(PNG_IMAGE_SIZE(*image));
    assert_true(png_image_finish_read(image, NULL, rgb, 0, NULL));
    return rgb;
}

static int write_sequence(const char *const names[2], enum orl_tone tone, const atomic_bool *cancel,
                          struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    const struct orl_display display = {.tone = tone, .exposure = 0.1};
    const struct orl_sequence_request how = {.asked = true, .columns = 2, .width_px = 32};
    char paths[4][128];
    const struct orl_sequence_frame frames[2] = {
        {names[0], path_of("one.png", paths[0]), {"22 Mar 09:30", "DGP 0.3"}},
        {names[1], path_of("two.png", paths[1]), {"22 Mar 10:30", ""}}};
    const struct orl_sequence sequence = {.files = &files,
                                          .display = &display,
                                          .how = &how,
                                          .frames = frames,
                                          .n_frames = 2,
                                          .title = "a room",
                                          .sheet = path_of("sheet.png", paths[2]),
                                          .animation = path_of("animation.png", paths[3]),
                                          .cancel = cancel};
    return orl_sequence_write(&sequence, err);
}

/* Two ramps overlap: equal radiances look alike in both, with any tone mapping. */
static void test_one_exposure(void **state)
{
    static const char *const names[2] = {"dark.hdr", "bright.hdr"};
    (void)state;
    write_ramp(names[0], 0.01, SIDE);
    write_ramp(names[1], 0.01 * pow(1000, 0.5), SIDE);
    for (int tone = 0; tone < ORL_TONES; tone++) {
        png_image image;
        assert_int_equal(write_sequence(names, (enum orl_tone)tone, NULL, NULL), 0);
        unsigned char *one = read_png("one.png", &image), *two = read_png("two.png", &image);
        int brightest = 0;
        for (uint32_t x = 0; x < SIDE / 2; x++) {
            const int a = one[3 * (x + SIDE / 2)], b = two[3 * x];
            assert_true(abs(a - b) <= 2); /* RGBE's last digit, in sRGB's steps */
            brightest = b > brightest ? b : brightest;
        }
        assert_true(brightest > 60);
        free(one);
        free(two);
    }
}

/* Alone, the dark picture would be as bright as the other. */
static void test_sheet_and_animation(void **state)
{
    static const char *const names[2] = {"dark.hdr", "bright.hdr"};
    png_image image;
    char path[128];
    (void)state;
    assert_int_equal(write_sequence(names, ORL_TONE_HUMAN, NULL, NULL), 0);
    unsigned char *one = read_png("one.png", &image);
    struct animation a = read_animation(path_of("animation.png", path));
    assert_int_equal(a.frames, 2);
    assert_int_equal(a.width, SIDE);
    assert_true(a.height > SIDE);
    assert_memory_equal(a.pixels, one, 3 * (size_t)SIDE * SIDE);
    animation_done(&a);
    free(one);
    unsigned char *sheet = read_png("sheet.png", &image);
    uint32_t gray[2] = {0, 0};
    assert_true(image.width > 2 * 32 && image.width < 4 * 32);
    for (size_t i = 0; i < (size_t)image.width * image.height; i++)
        gray[i % image.width >= image.width / 2] += 255U - sheet[3 * i];
    assert_true(gray[0] > gray[1] + gray[1] / 4);
    free(sheet);
}

/* A day from before dawn on: the animation begins with the night, and its still image is noon. */
static void test_poster(void **state)
{
    static const char *const dawn[2] = {"night.hdr", "bright.hdr"};
    static const char *const dusk[2] = {"bright.hdr", "night.hdr"};
    const size_t bytes = 3 * (size_t)SIDE * SIDE;
    png_image image;
    char path[128];
    (void)state;
    write_ramp("night.hdr", 0, SIDE);
    write_ramp("bright.hdr", 0.3, SIDE);
    assert_int_equal(write_sequence(dawn, ORL_TONE_HUMAN, NULL, NULL), 0);
    unsigned char *night = read_png("one.png", &image), *noon = read_png("two.png", &image);
    unsigned char *plain = read_png("animation.png", &image);
    struct animation a = read_animation(path_of("animation.png", path));
    assert_int_equal(a.read, 2);
    assert_memory_equal(a.pixels, night, bytes);
    assert_non_null(a.poster);
    assert_memory_equal(a.poster, noon, bytes);
    assert_memory_equal(plain, noon, bytes);
    animation_done(&a);
    free(plain);
    free(noon);
    assert_int_equal(write_sequence(dusk, ORL_TONE_HUMAN, NULL, NULL), 0);
    noon = read_png("one.png", &image);
    a = read_animation(path_of("animation.png", path));
    assert_null(a.poster);
    assert_memory_equal(a.pixels, noon, bytes);
    animation_done(&a);
    free(noon);
    free(night);
}

static void test_what_is_refused(void **state)
{
    static const char *const wider[2] = {"dark.hdr", "wide.hdr"};
    static const char *const absent[2] = {"dark.hdr", "none.hdr"};
    const atomic_bool cancelled = true;
    struct orl_error err = {0};
    char path[128];
    (void)state;
    write_ramp(wider[1], 1, SIDE + 1);
    remove(path_of("animation.png", path));
    assert_int_equal(write_sequence(wider, ORL_TONE_HUMAN, NULL, &err), ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "wide.hdr"));
    assert_int_equal(write_sequence(absent, ORL_TONE_HUMAN, NULL, &err), ORL_ERR_NOT_FOUND);
    assert_int_equal(write_sequence(wider, ORL_TONE_HUMAN, &cancelled, &err), ORL_ERR_CANCELLED);
    assert_null(fopen(path, "r"));
}

/* Night views only: black pictures, and no error. */
static void test_black(void **state)
{
    static const char *const names[2] = {"night.hdr", "night.hdr"};
    (void)state;
    write_ramp(names[0], 0, SIDE);
    for (int tone = 0; tone < ORL_TONES; tone++) {
        png_image image;
        assert_int_equal(write_sequence(names, (enum orl_tone)tone, NULL, NULL), 0);
        unsigned char *one = read_png("one.png", &image);
        for (size_t i = 0; i < 3 * (size_t)SIDE * SIDE; i++)
            assert_int_equal(one[i], 0);
        free(one);
    }
}

/* ---- The chart ------------------------------------------------------------------------------- */

static void count_text(void *ctx, const XML_Char *text, int length)
{
    char *all = ctx;
    const size_t used = strlen(all);
    if (used + (size_t)length + 2 < 4096)
        snprintf(all + used, 4096 - used, "%.*s\n", length, text);
}

/* Returns all texts of an SVG, one per line. */
static void read_texts(const char *path, char ret_texts[4096])
{
    XML_Parser parser = XML_ParserCreate(NULL);
    size_t size;
    unsigned char *bytes = scene_read_bytes(path, &size);
    ret_texts[0] = '\0';
    XML_SetUserData(parser, ret_texts);
    XML_SetCharacterDataHandler(parser, count_text);
    assert_int_equal(XML_Parse(parser, (const char *)bytes, (int)size, 1), XML_STATUS_OK);
    XML_ParserFree(parser);
    free(bytes);
}

static void test_chart(void **state)
{
    const struct orl_glare_hour hours[] = {
        {"06:30", 6.5, 0.159, 0.159, 0.159, ORL_GLARE_IMPERCEPTIBLE, true},
        {"07:30", 7.5, 0.31, 0.30, 0.32, ORL_GLARE_IMPERCEPTIBLE, false},
        {"08:30", 8.5, 0.41, 0.39, 0.43, ORL_GLARE_UNDECIDED, false},
        {"09:30", 9.5, 0.92, 0.90, 0.94, ORL_GLARE_INTOLERABLE, false},
        {"10:30", 10.5, NAN, NAN, NAN, ORL_GLARE_UNDECIDED, false}};
    char path[128], texts[4096];
    (void)state;
    path_of("dgp.svg", path);
    assert_int_equal(orl_glare_chart_write(hours, 5, "a <room> & day", ORL_CANVAS_SVG, path, NULL),
                     0);
    read_texts(path, texts);
    for (size_t i = 0; i < 5; i++)
        assert_non_null(strstr(texts, hours[i].label));
    assert_non_null(strstr(texts, "worst: 0.920 (0.900 to 0.940) at 09:30, intolerable"));
    assert_non_null(strstr(texts, "undecided"));
    assert_non_null(strstr(texts, "disturbing"));
    assert_non_null(strstr(texts, "no light"));
    /* One hour, no known hour, no hour at all. */
    for (size_t n = 0; n < 2; n++) {
        assert_int_equal(orl_glare_chart_write(hours + 4, n, "", ORL_CANVAS_SVG, path, NULL), 0);
        read_texts(path, texts);
        assert_null(strstr(texts, "worst"));
        assert_null(strstr(texts, "undecided"));
    }
    path_of("dgp.png", path);
    assert_int_equal(orl_glare_chart_write(hours, 5, "", ORL_CANVAS_PNG, path, NULL), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_animation_is_read_back),
                                       cmocka_unit_test(test_animation_is_whole_or_absent),
                                       cmocka_unit_test(test_one_exposure),
                                       cmocka_unit_test(test_sheet_and_animation),
                                       cmocka_unit_test(test_poster),
                                       cmocka_unit_test(test_what_is_refused),
                                       cmocka_unit_test(test_black),
                                       cmocka_unit_test(test_chart)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
