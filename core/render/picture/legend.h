/*
 * A picture with a legend below it: two lines of text, and a scale with ticks.
 *
 * Pixels from the upper left. Letters grow with the picture: sizes of the legend are in units, one
 * of which is a pixel in pictures of up to 640 pixels.
 */
#ifndef ORL_RENDER_PICTURE_LEGEND_H
#define ORL_RENDER_PICTURE_LEGEND_H

#include <oriel/error.h>
#include <oriel/picture.h>

#include "base/letters.h"

struct orl_sheet {
    struct orl_raster raster; /* of all; its pixels are owned */
    uint32_t width, height;   /* of the picture, which is at the upper left */
    double unit;
};

enum { ORL_LEGEND_TICKS = 72, ORL_LEGEND_TEXT = 96 };

struct orl_legend {
    const char *lines[2]; /* above the scale; the second may be NULL */
    enum orl_palette palette;
    size_t n_ticks;
    struct {
        double at; /* of the scale, 0..1 */
        char text[16];
    } ticks[ORL_LEGEND_TICKS]; /* from the left; texts that would meet are left out */
};

/* All white, with room for the picture and its legend. Returns 0 or ORL_ERR_NOMEM;
 * orl_sheet_done in either case. */
int orl_sheet_init(struct orl_sheet *sheet, uint32_t width, uint32_t height);
void orl_sheet_done(struct orl_sheet *sheet);

/* A pixel of the picture. */
unsigned char *orl_sheet_at(const struct orl_sheet *sheet, uint32_t x, uint32_t y);

void orl_sheet_draw_legend(const struct orl_sheet *sheet, const struct orl_legend *legend);

/* The same at another place, in pixels, and that many of them wide. */
void orl_legend_draw(const struct orl_raster *raster, const struct orl_legend *legend, double unit,
                     double left, double top, double width);

int orl_sheet_write(const struct orl_sheet *sheet, const char *path, struct orl_error *err);

#endif
