/*
 * A page that becomes a PNG, an SVG or a PDF: the same calls, the same picture. Charts and plans
 * are drawn with it.
 *
 * Frame: page units from the upper left corner, x to the right and y down. SVG has them as its
 * units; PNG has `scale` pixels for each, PDF as many points. What lies outside of the page is not
 * drawn. Colours are sRGB and cover what is below them.
 *
 * Letters of a PNG are the house's own strokes; SVG has text, as long as those letters are; PDF has
 * text in its standard fonts, no longer than those letters are.
 */
#ifndef ORIEL_CANVAS_H
#define ORIEL_CANVAS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>

enum orl_canvas_kind { ORL_CANVAS_PNG, ORL_CANVAS_SVG, ORL_CANVAS_PDF };

struct orl_canvas;

/* A white page. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO; ret_canvas is to be closed. */
int orl_canvas_open(enum orl_canvas_kind kind, const char *path, double width, double height,
                    double scale, struct orl_canvas **ret_canvas, struct orl_error *err);

/* Writes the file when code is 0 (to path.part, then sync and rename); frees the page in any case.
 * Returns code, or ORL_ERR_NOMEM or ORL_ERR_IO when writing failed. */
int orl_canvas_close(struct orl_canvas *canvas, int code, struct orl_error *err);

/* A convex polygon of n corners, in order, either way about. Of two that meet along an edge one has
 * the pixels on it. */
void orl_canvas_fill(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     const unsigned char rgb[3]);
void orl_canvas_disc(struct orl_canvas *canvas, double x, double y, double radius,
                     const unsigned char rgb[3]);

/* Through n points; ends and corners are round. weight: width of the stroke. */
void orl_canvas_path(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     double weight, const unsigned char rgb[3]);
void orl_canvas_line(struct orl_canvas *canvas, double x0, double y0, double x1, double y1,
                     double weight, const unsigned char rgb[3]);

enum orl_canvas_align { ORL_CANVAS_LEFT, ORL_CANVAS_MIDDLE, ORL_CANVAS_RIGHT };

struct orl_canvas_letters {
    double size;                 /* height of capitals, page units */
    enum orl_canvas_align align; /* what of the text stands at the place given */
    bool upright;                /* turned to the left, to read from below; aligned left only */
    bool bold;
    bool rimmed; /* with a rim of white, to be legible on what it crosses */
    unsigned char rgb[3];
};

/* UTF-8, standing on y. Control characters are drawn as spaces. */
void orl_canvas_text(struct orl_canvas *canvas, double x, double y,
                     const struct orl_canvas_letters *letters, const char *text);
/* How far a text reaches along its line, page units. */
double orl_canvas_text_width(const char *text, double size);

#endif
