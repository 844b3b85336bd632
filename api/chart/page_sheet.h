/*
 * The sheet that an annual page is drawn on: its measures, its letters, and how its values are
 * written. Texts stand on y; functions that draw lines of text return the y of the next one.
 */
#ifndef ORL_CHART_PAGE_SHEET_H
#define ORL_CHART_PAGE_SHEET_H

#include "chart/annual_page.h"

/* Page units: PNG has twice as many pixels, and PDF is A4. */
enum {
    ORL_PAGE_WIDTH = 960,
    ORL_PAGE_HEIGHT = 1358,
    ORL_PAGE_RIM = 40,
    ORL_PAGE_TITLE = 16, /* heights of capitals */
    ORL_PAGE_HEAD = 10,
    ORL_PAGE_TEXT = 8,
    ORL_PAGE_LINE = 17,      /* from one line to the next */
    ORL_PAGE_FINE_LINE = 14, /* likewise of running text */
    ORL_PAGE_HEADING = 6 + ORL_PAGE_LINE,
};

extern const unsigned char orl_page_ink[3], orl_page_gray[3];

struct orl_page_sheet {
    const struct orl_annual_page *page;
    struct orl_canvas *canvas;
};

/* Texts larger than ORL_PAGE_TEXT are bold. */
void orl_page_put(const struct orl_page_sheet *s, double x, double y, enum orl_canvas_align align,
                  double size, const unsigned char rgb[3], const char *text);
/* Cuts the text short, with dots, where it is wider than most. */
void orl_page_put_within(const struct orl_page_sheet *s, double x, double y, double most,
                         const unsigned char rgb[3], const char *text);
void orl_page_put_title(const struct orl_page_sheet *s, double y, const char *text); /* likewise */
double orl_page_put_heading(const struct orl_page_sheet *s, double x, double y, double right,
                            const char *text);

/* Breaks the text at spaces into lines of at most so much width. Returns how many lines there are,
 * n_most at most: the last one is cut short then. s: NULL to count them only. */
size_t orl_page_put_wrapped(const struct orl_page_sheet *s, double x, double y, double width,
                            size_t n_most, const unsigned char rgb[3], const char *text);

/* "55.1 % (52 to 57)". */
void orl_page_value_text(const struct orl_annual_value *value, const char *unit, char *ret_text,
                         size_t size);
const char *orl_page_figure_unit(const struct orl_annual_figure *figure);

/* ---- Parts ----------------------------------------------------------------------------------- */

struct orl_page_column {
    double x, y, right;
};

/* Verdicts of the page's grid in the right column, those of all grids together below what the left
 * column holds; where there are too many each goes on in the other. What finds no room between
 * there and bottom is of the page's grid first. Moves both y. */
void orl_page_draw_targets(const struct orl_page_sheet *s, struct orl_page_column *left,
                           struct orl_page_column *right, double bottom);

/* Warnings of the page's grid and of the whole job, across the page from y; nothing if there are
 * none. */
double orl_page_draw_warnings(const struct orl_page_sheet *s, double y);

/* A table of the sensors of a grid that has no map, down to bottom at most. */
double orl_page_draw_sensors(const struct orl_page_sheet *s, double y, double bottom);

#endif
