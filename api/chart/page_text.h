/*
 * The canvas of an annual page: its measures and letters, and the format of its values. y is the
 * baseline of a text. Functions that draw lines of text return the y of the next line.
 */
#ifndef ORL_CHART_PAGE_TEXT_H
#define ORL_CHART_PAGE_TEXT_H

#include "chart/charts.h"

/* Page units: PNG has twice as many pixels, and PDF is A4. */
enum {
    ORL_PAGE_WIDTH = 960,
    ORL_PAGE_HEIGHT = 1358,
    ORL_PAGE_MARGIN = 40,
    ORL_PAGE_TITLE = 16, /* heights of capitals */
    ORL_PAGE_HEAD = 10,
    ORL_PAGE_TEXT = 8,
    ORL_PAGE_LINE = 17,      /* distance between lines */
    ORL_PAGE_FINE_LINE = 14, /* likewise for running text */
    ORL_PAGE_HEADING = 6 + ORL_PAGE_LINE,
};

extern const unsigned char orl_page_ink[3], orl_page_gray[3];

struct orl_page_canvas {
    const struct orl_annual_page *page;
    struct orl_canvas *canvas;
};

/* Writes a text; one larger than ORL_PAGE_TEXT is bold. */
void orl_page_draw_text(const struct orl_page_canvas *s, double x, double y,
                        enum orl_canvas_align align, double size, const unsigned char rgb[3],
                        const char *text);
/* Writes a text, shortened with an ellipsis if it is wider than most. */
void orl_page_draw_text_within(const struct orl_page_canvas *s, double x, double y, double most,
                               const unsigned char rgb[3], const char *text);
void orl_page_draw_title(const struct orl_page_canvas *s, double y,
                         const char *text); /* shortened likewise */
double orl_page_draw_heading(const struct orl_page_canvas *s, double x, double y, double right,
                             const char *text);

/* Writes a text in lines of at most width, broken at spaces. Returns the number of lines, at
 * most n_most; the last one is shortened if the text is longer. s: NULL to only count the
 * lines. */
size_t orl_page_draw_wrapped(const struct orl_page_canvas *s, double x, double y, double width,
                             size_t n_most, const unsigned char rgb[3], const char *text);

/* Formats a value with its interval: "55.1 % (52 to 57)". */
void orl_page_value_text(const struct orl_annual_value *value, const char *unit, char *ret_text,
                         size_t size);
const char *orl_page_figure_unit(const struct orl_annual_figure *figure);

/* ---- Parts ----------------------------------------------------------------------------------- */

struct orl_page_column {
    double x, y, right;
};

/* Draws verdicts: those of the page's grid in the right column, those of all grids together
 * below the left column's contents. If a list is too long, it continues in the other column. If
 * both are too long, the grid's verdicts take precedence. Moves both y. */
void orl_page_draw_verdicts(const struct orl_page_canvas *s, struct orl_page_column *left,
                            struct orl_page_column *right, double bottom);

/* Draws warnings of the page's grid and of the whole job across the page, from y down. Draws
 * nothing if there are none. */
double orl_page_draw_warnings(const struct orl_page_canvas *s, double y);

/* Draws a table of the sensors of a grid without a map, no lower than bottom. */
double orl_page_draw_sensors(const struct orl_page_canvas *s, double y, double bottom);

#endif
