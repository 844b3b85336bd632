/* The stroke font: available letters, their position and rotation; lines. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text/stroke_font.h"

enum { WIDTH = 400, HEIGHT = 100 };
static unsigned char pixels[3 * WIDTH * HEIGHT];
static const struct orl_raster raster = {pixels, WIDTH, HEIGHT};

static void clear(void)
{
    memset(pixels, 0xff, sizeof pixels);
}

/* Returns the coverage of a pixel, 0: white, 1: black. */
static double ink_at(int x, int y)
{
    return 1 - pixels[3 * ((size_t)y * WIDTH + (size_t)x)] / 255.0;
}

struct extent {
    int x0, y0, x1, y1; /* bounds of pixels that are more than half covered */
    double ink;         /* pixels */
};

static struct extent measure_ink(void)
{
    struct extent e = {WIDTH, HEIGHT, -1, -1, 0};
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            e.ink += ink_at(x, y);
            if (ink_at(x, y) <= 0.5)
                continue;
            e.x0 = x < e.x0 ? x : e.x0;
            e.x1 = x > e.x1 ? x : e.x1;
            e.y0 = y < e.y0 ? y : e.y0;
            e.y1 = y > e.y1 ? y : e.y1;
        }
    return e;
}

/* A line's area is its length by its width, and half a circle at each end. Coverage by distance is
 * exact along straight edges, and to a hundredth or so around the ends. */
static void test_lines(void **state)
{
    const struct orl_pen pen = {.weight = 4};
    (void)state;
    clear();
    orl_raster_line(&raster, &pen, 20, 50, 120, 50);
    const struct extent flat = measure_ink();
    assert_true(fabs(flat.ink - (400 + 4 * 3.14159265)) < 1);
    assert_true(flat.y0 == 48 && flat.y1 == 51);
    clear();
    orl_raster_line(&raster, &pen, 20, 10, 80, 90); /* 100 long */
    assert_true(fabs(measure_ink().ink - flat.ink) < 2);
}

/* An H of 40 pixels is on its line, and has the stated height and width. */
static void test_frame(void **state)
{
    const struct orl_pen pen = {.size = 40, .weight = 2};
    (void)state;
    clear();
    orl_stroke_text_draw(&raster, &pen, 100, 80, "H");
    const struct extent e = measure_ink();
    assert_true(abs(e.y1 - 80) <= 1 && abs(e.y0 - 39) <= 1);
    assert_true(e.x0 > 100 && e.x1 < 100 + orl_stroke_text_width("H", 40));
    assert_true(orl_stroke_text_width("HH", 40) == 2 * orl_stroke_text_width("H", 40));
    assert_true(orl_stroke_text_width("", 40) == 0);
}

/* Rotated by a quarter turn: upwards, with its letters to the left of the line. */
static void test_turned(void **state)
{
    struct orl_pen pen = {.size = 20};
    (void)state;
    clear();
    orl_stroke_text_draw(&raster, &pen, 50, 90, "Lx");
    const struct extent flat = measure_ink();
    clear();
    pen.turn = acos(0);
    orl_stroke_text_draw(&raster, &pen, 50, 90, "Lx");
    const struct extent up = measure_ink();
    assert_true(fabs(up.ink - flat.ink) < 0.02 * flat.ink);
    assert_true(abs((up.y1 - up.y0) - (flat.x1 - flat.x0)) <= 1);
    assert_true(up.y1 < 90 && abs(up.x1 - 50) <= 2 && abs(up.x0 - 30) <= 2);
}

static double width_of(const char *text)
{
    return orl_stroke_text_width(text, 20);
}

/* Every letter of ASCII and Latin-1 exists, and no two look the same. */
static void test_alphabet(void **state)
{
    enum { LAST = 0xff };
    static unsigned char seen[LAST + 1][sizeof pixels / 4];
    const struct orl_pen pen = {.size = 40};
    const struct orl_raster small = {pixels, WIDTH / 4, HEIGHT};
    const struct orl_stroke_glyph *none = orl_stroke_glyph_find(0x4e00);
    (void)state;
    for (unsigned code = '!'; code <= LAST; code++) {
        char text[3] = {(char)code, 0, 0};
        if (code >= 0x7f && code <= 0xa0)
            continue;
        if (code >= 0x80) {
            text[0] = (char)(0xc0 | code >> 6);
            text[1] = (char)(0x80 | (code & 0x3f));
        }
        if (orl_stroke_glyph_find(code) == none)
            continue;
        clear();
        orl_stroke_text_draw(&small, &pen, 10, 70, text);
        assert_true(measure_ink().ink > 10);
        memcpy(seen[code], pixels, sizeof seen[code]);
        for (unsigned other = '!'; other < code; other++)
            if (memcmp(seen[other], seen[code], sizeof seen[code]) == 0)
                fail_msg("U+%04X looks as U+%04X", code, other);
    }
    for (unsigned code = 0x20; code < 0x7f; code++)
        assert_ptr_not_equal(orl_stroke_glyph_find(code), none);
}

/* Invalid UTF-8 and missing letters give a box each; a NUL ends the text. */
static void test_strange_texts(void **state)
{
    const double box = width_of("\xe4\xb8\x80");
    (void)state;
    assert_true(box > 0);
    assert_true(width_of("\xff\xfe") == 2 * box);
    assert_true(width_of("\xe4\xb8") == 2 * box);
    assert_true(width_of("\xc3") == box);
    assert_true(width_of("\xf0\x9f\x98\x80") == box);
    assert_true(width_of("\x07") == box);
    assert_true(width_of("\xc3\xa4") == width_of("a"));
}

/* Text beyond the edges, and of absurd sizes: nothing is written outside the picture. */
static void test_outside(void **state)
{
    static const double places[] = {-1e9, -30, 0, 390, 1e9, INFINITY, -INFINITY, NAN};
    (void)state;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
            const struct orl_pen pen = {.size = 30, .turn = (double)i};
            orl_stroke_text_draw(&raster, &pen, places[i], places[k], "Wg@");
            orl_raster_line(&raster, &pen, places[i], places[k], places[k], places[i]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines),         cmocka_unit_test(test_frame),
        cmocka_unit_test(test_turned),        cmocka_unit_test(test_alphabet),
        cmocka_unit_test(test_strange_texts), cmocka_unit_test(test_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
