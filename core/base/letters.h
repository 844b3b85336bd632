/*
 * Letters and lines, drawn into pixels without a library and without memory of their own.
 *
 * The letters are drawn here for Oriel: each is a few strokes of a round pen along straight lines
 * and parabolas (letters_table.c). A pixel is covered by how near its middle is to the stroke, so
 * edges are smooth at any size; the same calls give the same bytes.
 *
 * Texts are UTF-8. There are letters for ASCII, Latin-1, and what pictures and charts say beside
 * (– − × ± ≤ ≥ Δ √); others are drawn as an empty box.
 *
 * Frame: pixels from the upper left corner of the picture, x to the right and y down; the middle of
 * the first pixel is (0.5, 0.5). What lies outside of the picture is not drawn.
 */
#ifndef ORL_BASE_LETTERS_H
#define ORL_BASE_LETTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Three bytes a pixel, red first, rows from the top without gaps. */
struct orl_raster {
    unsigned char *rgb;
    uint32_t width, height;
};

struct orl_pen {
    double
        size; /* height of capitals, pixels; small x has 0.7 of it, and letters reach 0.3 below */
    double weight; /* width of strokes, pixels; 0: what suits the size */
    double turn;   /* direction of the line, radians anticlockwise; 0: to the right */
    unsigned char rgb[3];
};

/* How far the text reaches along its line, pixels. */
double orl_letters_width(const char *text, double size);

/* The text from (x, y): the left end of the line that it stands on. */
void orl_letters_draw(const struct orl_raster *raster, const struct orl_pen *pen, double x,
                      double y, const char *text);

/* A straight line with round ends, of the pen's weight (1 where that is 0) and colour. */
void orl_raster_line(const struct orl_raster *raster, const struct orl_pen *pen, double x0,
                     double y0, double x1, double y1);

/* A rectangle's pixels; of those that it has in part, what their middle says. */
void orl_raster_fill(const struct orl_raster *raster, double x0, double y0, double x1, double y1,
                     const unsigned char rgb[3]);

#endif
