/*
 * A page of PDF 1.4 (ISO 32000-1): polygons, lines, and text in fonts that every reader has
 * (Helvetica and Symbol). The file contains no date, so that equal calls give equal bytes.
 *
 * Frame: page units from the upper left corner, x to the right and y down, as in a canvas
 * (oriel/base/canvas.h).
 */
#ifndef ORL_RENDER_FILM_PDF_H
#define ORL_RENDER_FILM_PDF_H

#include <oriel/base/canvas.h>

struct orl_pdf;

/* Creates a page. scale: points (1/72 inch) per unit. Returns 0 or ORL_ERR_NOMEM. */
int orl_pdf_new(double width, double height, double scale, struct orl_pdf **ret_pdf);
void orl_pdf_free(struct orl_pdf *pdf); /* NULL is allowed */

void orl_pdf_fill(struct orl_pdf *pdf, size_t n, const double x[], const double y[],
                  const unsigned char rgb[3]);
void orl_pdf_path(struct orl_pdf *pdf, size_t n, const double x[], const double y[], double weight,
                  const unsigned char rgb[3]);
/* Draws a text, made narrower if it exceeds `most`. Characters outside Latin-1 and Symbol become a
 * box. rim: width of a white rim, for letters that request one. */
void orl_pdf_text(struct orl_pdf *pdf, double x, double y, double most, double rim,
                  const struct orl_canvas_text_style *text_style, const char *text);

/* Writes the page. Returns 0, ORL_ERR_NOMEM (also if an earlier call failed), ORL_ERR_IO or
 * ORL_ERR_FULL. */
int orl_pdf_write(struct orl_pdf *pdf, const char *path, struct orl_error *err);

#endif
