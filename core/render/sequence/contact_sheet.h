/*
 * A contact sheet: pictures of one size side by side under a title, each with lines of text below.
 * Also the strip of text for a single picture.
 *
 * Coordinates are pixels from the upper left. Pictures are reduced by averages over the area of a
 * pixel, in linear light. Letters scale with the pictures.
 */
#ifndef ORL_RENDER_SEQUENCE_CONTACT_SHEET_H
#define ORL_RENDER_SEQUENCE_CONTACT_SHEET_H

#include <oriel/job/picture.h>

#include "base/text/stroke_font.h"

struct orl_contact_sheet {
    struct orl_raster raster; /* its pixels are owned */
    uint32_t columns, rows;
    uint32_t width, height;  /* size of a picture on the sheet */
    uint32_t step_x, step_y; /* distance from one to the next */
    uint32_t left, top;      /* position of the first */
    double unit;             /* pixels per unit of the letters */
    double linear[256];      /* linear value of each sRGB byte */
};

/* Makes a white sheet with the title. width, height: size of the original pictures. Returns 0 or
 * ORL_ERR_NOMEM; call orl_contact_sheet_done in either case. */
int orl_contact_sheet_init(struct orl_contact_sheet *sheet, const struct orl_sequence *sequence,
                           uint32_t width, uint32_t height);
void orl_contact_sheet_done(struct orl_contact_sheet *sheet);

/* Draws a picture, three bytes a pixel, at its position, with its texts. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_contact_sheet_put(struct orl_contact_sheet *sheet, size_t index, const unsigned char *rgb,
                          uint32_t width, uint32_t height, const struct orl_sequence_frame *frame);

/*
 * orl_strip_height returns the height of the strip below a single picture of that width.
 * orl_strip_draw draws its text from row `top` on: both lines side by side, as large as they fit.
 */
uint32_t orl_strip_height(uint32_t width);
void orl_strip_draw(const struct orl_raster *raster, uint32_t top,
                    const struct orl_sequence_frame *frame);

#endif
