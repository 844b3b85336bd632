/*
 * A contact sheet: pictures of one size side by side, each with lines of text below, under a title.
 * Also such a strip of text for a single picture.
 *
 * Pixels from the upper left. Pictures are made smaller by averages over what a pixel covers, in
 * linear light. Letters grow with the pictures.
 */
#ifndef ORL_RENDER_SEQUENCE_SHEET_H
#define ORL_RENDER_SEQUENCE_SHEET_H

#include <oriel/sequence.h>

#include "base/letters.h"

struct orl_contact_sheet {
    struct orl_raster raster; /* its pixels are owned */
    uint32_t columns, rows;
    uint32_t width, height;  /* of a picture on it */
    uint32_t step_x, step_y; /* from one to the next */
    uint32_t left, top;      /* of the first */
    double unit;             /* pixels of letters' units */
    double linear[256];      /* what sRGB's bytes stand for */
};

/* All white but the title. width, height: of the pictures as they are. 0 or ORL_ERR_NOMEM;
 * orl_contact_sheet_done in either case. */
int orl_contact_sheet_init(struct orl_contact_sheet *sheet, const struct orl_sequence *sequence,
                           uint32_t width, uint32_t height);
void orl_contact_sheet_done(struct orl_contact_sheet *sheet);

/* Puts a picture, three bytes a pixel, in its place, with its texts. Returns 0 or ORL_ERR_NOMEM. */
int orl_contact_sheet_put(struct orl_contact_sheet *sheet, size_t index, const unsigned char *rgb,
                          uint32_t width, uint32_t height, const struct orl_sequence_frame *frame);

/* Height of the strip below a picture of that width that stands alone; and its text drawn there,
 * from row `top` on: both lines side by side, as large as there is room. */
uint32_t orl_strip_height(uint32_t width);
void orl_strip_draw(const struct orl_raster *raster, uint32_t top,
                    const struct orl_sequence_frame *frame);

#endif
