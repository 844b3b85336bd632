#include "chart/page_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const unsigned char orl_page_ink[3] = {26, 26, 26}, orl_page_gray[3] = {105, 105, 105};
static const unsigned char faint[3] = {205, 205, 205};

enum { LINE_BYTES = 320 }; /* more than fits across a page */

void orl_page_draw_text(const struct orl_page_canvas *s, double x, double y,
                        enum orl_canvas_align align, double size, const unsigned char rgb[3],
                        const char *text)
{
    struct orl_canvas_text_style letters = {
        .size = size, .align = align, .bold = size > ORL_PAGE_TEXT};
    memcpy(letters.rgb, rgb, 3);
    orl_canvas_text(s->canvas, x, y, &letters, text);
}

/* Returns true for UTF-8 continuation bytes. */
static bool is_inside(char byte)
{
    return ((unsigned char)byte & 0xc0) == 0x80;
}

static size_t drop_last(char *text, size_t length)
{
    do
        length--;
    while (length > 0 && is_inside(text[length]));
    text[length] = '\0';
    return length;
}

/* Shortens the text to the width `most`, with an ellipsis at its end. */
static void cut_to(char text[LINE_BYTES], double size, double most)
{
    size_t length = strlen(text);
    while (length > LINE_BYTES - 3)
        length = drop_last(text, length);
    memcpy(text + length, "..", 3);
    while (length > 1 && orl_canvas_text_width(text, size) > most) {
        length = drop_last(text, length);
        memcpy(text + length, "..", 3);
    }
}

static void put_within(const struct orl_page_canvas *s, double x, double y, double most,
                       double size, const unsigned char rgb[3], const char *text)
{
    char cut[LINE_BYTES];
    snprintf(cut, sizeof cut, "%s", text);
    if (strlen(text) >= sizeof cut || orl_canvas_text_width(cut, size) > most)
        cut_to(cut, size, most);
    orl_page_draw_text(s, x, y, ORL_CANVAS_LEFT, size, rgb, cut);
}

void orl_page_draw_text_within(const struct orl_page_canvas *s, double x, double y, double most,
                               const unsigned char rgb[3], const char *text)
{
    put_within(s, x, y, most, ORL_PAGE_TEXT, rgb, text);
}

void orl_page_draw_title(const struct orl_page_canvas *s, double y, const char *text)
{
    put_within(s, ORL_PAGE_MARGIN, y, ORL_PAGE_WIDTH - 2 * ORL_PAGE_MARGIN, ORL_PAGE_TITLE,
               orl_page_ink, text);
}

double orl_page_draw_heading(const struct orl_page_canvas *s, double x, double y, double right,
                             const char *text)
{
    orl_page_draw_text(s, x, y, ORL_CANVAS_LEFT, ORL_PAGE_HEAD, orl_page_ink, text);
    orl_canvas_line(s->canvas, x, y + 6, right, y + 6, 0.8, faint);
    return y + ORL_PAGE_HEADING;
}

/* Returns the number of bytes of the text's first line. It ends at a space, or within a word
 * that is wider than a line. */
static size_t line_length(const char *text, double width)
{
    char line[LINE_BYTES] = "";
    size_t fits = 0, length = 0;
    while (text[length] && length + 1 < sizeof line) {
        line[length] = text[length];
        line[++length] = '\0';
        if (is_inside(text[length]))
            continue;
        if (orl_canvas_text_width(line, ORL_PAGE_TEXT) > width)
            break;
        if (!text[length] || text[length] == ' ')
            fits = length;
    }
    if (fits > 0 || length == 0)
        return fits;
    if (text[length])
        length = drop_last(line, length);
    return length > 0 ? length : 1;
}

size_t orl_page_draw_wrapped(const struct orl_page_canvas *s, double x, double y, double width,
                             size_t n_most, const unsigned char rgb[3], const char *text)
{
    size_t n = 0;
    while (*text && n < n_most) {
        const size_t length = line_length(text, width);
        const char *rest = text + length + (text[length] == ' ');
        char line[LINE_BYTES];
        n++;
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        if (*rest && n == n_most)
            cut_to(line, ORL_PAGE_TEXT, width);
        if (s)
            orl_page_draw_text(s, x, y, ORL_CANVAS_LEFT, ORL_PAGE_TEXT, rgb, line);
        y += ORL_PAGE_FINE_LINE;
        text = rest;
    }
    return n;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static void put_number(double value, const char *unit, char *ret_text, size_t size)
{
    const bool percent = unit[0] == '%', counts = unit[0] == 'h';
    snprintf(ret_text, size, percent ? "%.1f" : counts || value >= 100 ? "%.0f" : "%.3g", value);
}

void orl_page_value_text(const struct orl_annual_value *value, const char *unit, char *ret_text,
                         size_t size)
{
    char middle[32], low[32], high[32];
    const bool sum = strcmp(unit, "lx h") == 0; /* values are large: written in thousands */
    const double scale = sum ? 1e-3 : 1;
    put_number(scale * value->value, unit, middle, sizeof middle);
    put_number(scale * value->low, unit, low, sizeof low);
    put_number(scale * value->high, unit, high, sizeof high);
    unit = sum ? "klx h" : unit;
    if (isnan(value->low))
        snprintf(ret_text, size, "%s %s", middle, unit);
    else
        snprintf(ret_text, size, "%s %s (%s to %s)", middle, unit, low, high);
}

const char *orl_page_figure_unit(const struct orl_annual_figure *figure)
{
    return figure->aggregate == ORL_AGGREGATE_SHARE ? "%" : orl_annual_unit(figure->metric.kind);
}
