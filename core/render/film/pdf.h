/*
 * A page of PDF 1.4 (ISO 32000-1): polygons, lines, and text in the fonts that every reader has
 * (Helvetica and Symbol). The same calls give the same bytes: no date is in it.
 *
 * Frame: page units from the upper left corner, x to the right and y down, as a canvas has them
 * (oriel/canvas.h).
 */
#ifndef ORL_RENDER_FILM_PDF_H
#define ORL_RENDER_FILM_PDF_H

#include <oriel/canvas.h>

struct orl_pdf;

/* scale: points (1/72 inch) for each unit. Returns 0 or ORL_ERR_NOMEM. */
int orl_pdf_new(double width, double height, double scale, struct orl_pdf **ret_pdf);
void orl_pdf_free(struct orl_pdf *pdf); /* NULL is fine */

void orl_pdf_fill(struct orl_pdf *pdf, size_t n, const double x[], const double y[],
                  const unsigned char rgb[3]);
void orl_pdf_path(struct orl_pdf *pdf, size_t n, const double x[], const double y[], double weight,
                  const unsigned char rgb[3]);
/* No wider than most. What neither Latin-1 nor Symbol has is a box. rim: of white about letters
 * that ask for it. */
void orl_pdf_text(struct orl_pdf *pdf, double x, double y, double most, double rim,
                  const struct orl_canvas_letters *letters, const char *text);

/* ORL_ERR_NOMEM (of any call before, too), _IO, _FULL. */
int orl_pdf_write(struct orl_pdf *pdf, const char *path, struct orl_error *err);

#endif
