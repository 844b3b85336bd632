/*
 * A picture with a legend below it: two lines of text, and a scale with ticks.
 *
 * Coordinates are pixels from the upper left. Letters scale with the picture: sizes of the legend
 * are in units, which are one pixel in pictures up to 640 pixels wide.
 */
#ifndef ORL_RENDER_PICTURE_LEGEND_H
#define ORL_RENDER_PICTURE_LEGEND_H

#include <oriel/base/error.h>
#include <oriel/job/picture.h>

#include "base/text/stroke_font.h"

struct orl_sheet {
    struct orl_raster raster; /* picture and legend; its pixels are owned */
    uint32_t width, height;   /* size of the picture, which is at the upper left */
    double unit;
};

enum { ORL_LEGEND_TICKS = 72, ORL_LEGEND_TEXT = 96 };

struct orl_legend {
    const char *lines[2]; /* above the scale; the second may be NULL */
    enum orl_palette palette;
    size_t n_ticks;
    struct {
        double at; /* position on the scale, 0..1 */
        char text[16];
    } ticks[ORL_LEGEND_TICKS]; /* from left to right; overlapping texts are omitted */
};

/* Makes a white sheet with room for the picture and its legend. Returns 0 or ORL_ERR_NOMEM; call
 * orl_sheet_done in either case. */
int orl_sheet_init(struct orl_sheet *sheet, uint32_t width, uint32_t height);
void orl_sheet_done(struct orl_sheet *sheet);

/* Returns the address of a pixel of the picture. */
unsigned char *orl_sheet_at(const struct orl_sheet *sheet, uint32_t x, uint32_t y);

void orl_sheet_draw_legend(const struct orl_sheet *sheet, const struct orl_legend *legend);

/* Draws a legend at another position; left, top and width in pixels. */
void orl_legend_draw(const struct orl_raster *raster, const struct orl_legend *legend, double unit,
                     double left, double top, double width);

int orl_sheet_write(const struct orl_sheet *sheet, const char *path, struct orl_error *err);

#endif
