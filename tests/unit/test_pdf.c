/* PDF pages: structure, drawn content, and letters with the right codes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/canvas.h>
#include <zlib.h>

#include "support/scene_text.h"
#include "support/scratch.h"

static const unsigned char red[3] = {255, 0, 51};

static void draw_text(const char *path, const char *text,
                      const struct orl_canvas_text_style *letters)
{
    static const double x[] = {10, 20, 20}, y[] = {10, 10, 30};
    struct orl_canvas *canvas = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_canvas_open(ORL_CANVAS_PDF, path, 400, 300, 0.5, &canvas, &err), 0);
    orl_canvas_fill(canvas, 3, x, y, red);
    orl_canvas_line(canvas, 1, 2, 3.5, 4, 1.25, red);
    orl_canvas_text(canvas, 100, 200, letters, text);
    assert_int_equal(orl_canvas_close(canvas, 0, &err), 0);
}

/* Returns the page's content stream; the caller frees it. */
static char *content_of(const char *path)
{
    size_t size;
    char *file = (char *)scene_read_bytes(path, &size), *text = calloc(1, 1 << 16);
    unsigned long length = 0, room = (1 << 16) - 1;
    assert_non_null(text);
    /* Text up to there, bytes from there on. */
    const char *at = file;
    while (memcmp(at, "/Length ", 8) != 0)
        at++;
    assert_int_equal(sscanf(at, "/Length %lu", &length), 1);
    at = strstr(at, "stream\n") + 7;
    assert_int_equal(uncompress((unsigned char *)text, &room, (const unsigned char *)at, length),
                     Z_OK);
    assert_memory_equal(at + length, "\nendstream\n", 11);
    free(file);
    return text;
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

/* Every object is at its offset in the table, and the table is at the offset given at the end. */
static void test_structure(void **state)
{
    const struct orl_canvas_text_style letters = {.size = 10};
    const char *path = scratch_path("page.pdf");
    size_t size;
    (void)state;
    draw_text(path, "A page", &letters);
    char *file = (char *)scene_read_bytes(path, &size), *end = file + size;
    assert_memory_equal(file, "%PDF-1.4\n", 9);
    assert_memory_equal(end - 6, "%%EOF\n", 6);
    const char *at = end - 10;
    while (memcmp(at, "startxref\n", 10) != 0)
        at--;
    const char *table = file + strtol(at + 10, NULL, 10);
    int objects = 0;
    assert_int_equal(sscanf(table, "xref\n0 %d\n", &objects), 1);
    assert_int_equal(objects, 11);
    for (int i = 1; i < objects; i++) {
        char head[32];
        const long offset = strtol(table + 10 + 20 * i, NULL, 10);
        snprintf(head, sizeof head, "%d 0 obj\n<<", i);
        assert_true(offset > 0 && offset < table - file);
        assert_memory_equal(file + offset, head, strlen(head));
    }
    assert_memory_equal(table + 10 + 20L * objects, "trailer\n", 8);
    free(file);
}

static void test_what_is_drawn(void **state)
{
    const struct orl_canvas_text_style plain = {.size = 7.2, .align = ORL_CANVAS_LEFT},
                                       up = {.size = 7.2,
                                             .upright = true,
                                             .bold = true,
                                             .rimmed = true};
    const char *path = scratch_path("page.pdf");
    (void)state;
    draw_text(path, "a (b) \\ c", &plain);
    char *text = content_of(path);
    assert_says(text, "0.5 0 0 -0.5 0 150 cm");
    assert_says(text, "1 0 0.2 rg 1 0 0.2 RG 0.3 w 10.00 10.00 m 20.00 10.00 l 20.00 30.00 l b\n");
    assert_says(text, "1 0 0.2 RG 1.25 w 1.00 2.00 m 3.50 4.00 l S\n");
    assert_says(text, "1 0 0 -1 100.00 200.00 Tm /F0 10.000 Tf (a \\(b\\) \\\\ c) Tj ET\n");
    free(text);
    draw_text(path, "up", &up);
    text = content_of(path);
    assert_says(text, "BT 1 Tr ");
    assert_says(text, "1 1 1 RG 0 -1 -1 0 100.00 200.00 Tm /F1 10.000 Tf (up) Tj ET\n");
    assert_says(text, "BT 0 Tr ");
    free(text);
}

/* Latin-1 by its codes, some more letters, signs of Symbol; other characters become boxes, control
 * characters blanks. */
static void test_stroke_font(void **state)
{
    static const struct {
        const char *text, *codes;
    } cases[] = {
        {"m\xc2\xb2 \xc3\xbc", "/F0 10.000 Tf (m\\262 \\374) Tj ET"},
        {"\xc4\xb0zmir \xe2\x80\x93 \xc5\x9f", "/F0 10.000 Tf (\\222zmir \\200 \\225) Tj ET"},
        {"\xe2\x89\xa5 5", "/F2 10.000 Tf (\\263) Tj /F0 10.000 Tf ( 5) Tj ET"},
        {"\xe5\x85\x89\n", "/F3 10.000 Tf (o) Tj /F0 10.000 Tf ( ) Tj ET"},
        {"\xff\xc3", "/F3 10.000 Tf (oo) Tj ET"},
        {"", "Tm ET"},
    };
    const struct orl_canvas_text_style letters = {.size = 7.2};
    const char *path = scratch_path("page.pdf");
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        draw_text(path, cases[i].text, &letters);
        char *text = content_of(path);
        assert_says(text, cases[i].codes);
        free(text);
    }
}

/* No text is wider than the space it was laid out with; right-aligned text ends at its place. */
static void test_no_text_is_wider_than_laid_out(void **state)
{
    const struct orl_canvas_text_style right = {.size = 7.2, .align = ORL_CANVAS_RIGHT};
    const char *path = scratch_path("page.pdf"), *wide = "WWWWWWWWWW";
    double squeezed, left, y;
    (void)state;
    draw_text(path, wide, &right);
    char *text = content_of(path);
    const char *at = strstr(text, "BT 0 Tr ");
    assert_non_null(at);
    assert_int_equal(
        sscanf(at, "BT 0 Tr %lf Tz %*f %*f %*f rg 1 0 0 -1 %lf %lf", &squeezed, &left, &y), 3);
    const double width = 10 * 10 * 0.944 * squeezed / 100;
    assert_true(squeezed <= 100);
    assert_true(width <= orl_canvas_text_width(wide, 7.2) + 0.05);
    assert_true(left + width > 99.9 && left + width < 100.1);
    free(text);
}

static void test_a_folder_that_is_not_there(void **state)
{
    struct orl_canvas *canvas = NULL;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(
        orl_canvas_open(ORL_CANVAS_PDF, scratch_path("none/page.pdf"), 40, 30, 1, &canvas, &err),
        0);
    assert_true(orl_canvas_close(canvas, 0, &err) < 0);
    assert_int_equal(
        orl_canvas_open(ORL_CANVAS_PDF, scratch_path("none/page.pdf"), 40, 30, 1, &canvas, &err),
        0);
    assert_int_equal(orl_canvas_close(canvas, ORL_ERR_CANCELLED, &err), ORL_ERR_CANCELLED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_structure, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_what_is_drawn, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_stroke_font, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_no_text_is_wider_than_laid_out, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_a_folder_that_is_not_there, scratch_set_up,
                                        scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
