/*
 * Draws text and lines into pixels, without a library and without allocating memory.
 *
 * The font was made for Oriel. Each glyph consists of a few strokes of a round pen along straight
 * lines and parabolas (stroke_glyphs.c). The coverage of a pixel is computed from the distance of
 * its middle to the stroke, so edges are smooth at any size. The same calls give the same bytes.
 *
 * Texts are UTF-8. The font has ASCII, Latin-1, and some characters for pictures and charts (– − ×
 * ± ≤ ≥ Δ √); other characters are drawn as an empty box.
 *
 * Frame: pixels from the upper left corner of the picture, x to the right and y down; the middle of
 * the first pixel is (0.5, 0.5). Content outside the picture is clipped.
 */
#ifndef ORL_BASE_TEXT_STROKE_FONT_H
#define ORL_BASE_TEXT_STROKE_FONT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Glyphs of the font. Units: capitals are 20 high, small x is 14, descenders reach to -6; y is up,
 * and glyphs stand on y = 0.
 *
 * A shape is a text of strokes separated by ';', with points "x,y" separated by spaces. A point
 * with '~' is the middle point of a parabola; between two such points the stroke passes half way.
 * '@' before the first point marks a closed stroke.
 */

struct orl_stroke_glyph {
    uint32_t code;     /* Unicode */
    int width;         /* width between the strokes' middles; ORL_STROKE_GLYPH_GAP is added */
    const char *shape; /* strokes of the glyph */
    uint32_t base;     /* glyph drawn beneath the shape; 0: none */
};

enum { ORL_STROKE_GLYPH_HEIGHT = 20, ORL_STROKE_GLYPH_GAP = 5 };

/* Returns the glyph of a character, or a box for an unknown one. Never NULL. */
const struct orl_stroke_glyph *orl_stroke_glyph_find(uint32_t code);

/* RGB picture with three bytes per pixel, red first, rows from the top without gaps. */
struct orl_raster {
    unsigned char *rgb;
    uint32_t width, height;
};

struct orl_pen {
    double size;   /* height of capitals, pixels; small x has 0.7 of it, and descenders reach 0.3
                      below */
    double weight; /* width of strokes, pixels; 0: chosen by the size */
    double turn;   /* direction of the line, radians anticlockwise; 0: to the right */
    unsigned char rgb[3];
};

/* Returns the length of the text along its line, pixels. */
double orl_stroke_text_width(const char *text, double size);

/* Draws the text from (x, y), the left end of its baseline. */
void orl_stroke_text_draw(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                          double y, const char *text);

/* Draws a straight line with round ends in the pen's weight (1 if that is 0) and colour. */
void orl_raster_line(const struct orl_raster *raster, const struct orl_pen *pen, double x0,
                     double y0, double x1, double y1);

#endif
