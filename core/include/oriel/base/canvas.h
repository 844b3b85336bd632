/*
 * Canvas for charts and plans: a page that is written as PNG, SVG or PDF with the same calls.
 *
 * Frame: page units from the upper left corner, x to the right and y down. They are the units of
 * SVG, `scale` pixels each in PNG, and `scale` points each in PDF. Content outside the page is
 * clipped. Colours are opaque sRGB.
 *
 * PNG text uses the built-in stroke font. SVG text is stretched to the length of that font. PDF
 * text uses the standard fonts, and is no longer than that font.
 */
#ifndef ORIEL_BASE_CANVAS_H
#define ORIEL_BASE_CANVAS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

enum orl_canvas_kind { ORL_CANVAS_PNG, ORL_CANVAS_SVG, ORL_CANVAS_PDF };

struct orl_canvas;

/* Opens a white page. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. The caller closes ret_canvas. */
int orl_canvas_open(enum orl_canvas_kind kind, const char *path, double width, double height,
                    double scale, struct orl_canvas **ret_canvas, struct orl_error *err);

/* Writes the file if code is 0 (to path.part, then sync and rename), and always frees the page.
 * Returns code, or ORL_ERR_NOMEM or ORL_ERR_IO if writing fails. */
int orl_canvas_close(struct orl_canvas *canvas, int code, struct orl_error *err);

/* Fills a convex polygon of n corners, in either orientation. Pixels on an edge that two polygons
 * share belong to one of them only. */
void orl_canvas_fill(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     const unsigned char rgb[3]);
void orl_canvas_disc(struct orl_canvas *canvas, double x, double y, double radius,
                     const unsigned char rgb[3]);

/* Strokes a path through n points; ends and corners are round. weight: width of the stroke. */
void orl_canvas_path(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     double weight, const unsigned char rgb[3]);
void orl_canvas_line(struct orl_canvas *canvas, double x0, double y0, double x1, double y1,
                     double weight, const unsigned char rgb[3]);

enum orl_canvas_align { ORL_CANVAS_LEFT, ORL_CANVAS_MIDDLE, ORL_CANVAS_RIGHT };

struct orl_canvas_text_style {
    double size;                 /* height of capitals, page units */
    enum orl_canvas_align align; /* alignment of the text relative to the given position */
    bool upright;                /* rotated to the left, to read from below; left-aligned only */
    bool bold;
    bool rimmed; /* with a white outline, to be legible on crossing lines */
    unsigned char rgb[3];
};

/* Draws UTF-8 text with its baseline at y. Control characters are drawn as spaces. */
void orl_canvas_text(struct orl_canvas *canvas, double x, double y,
                     const struct orl_canvas_text_style *text_style, const char *text);
/* Returns the length of a text along its line, page units. */
double orl_canvas_text_width(const char *text, double size);

#endif
