/* Image files: PNG, animated PNG, OpenEXR, the reader of Radiance pictures, and pages of PDF. */
#ifndef ORL_RENDER_FILM_IMAGE_FILES_H
#define ORL_RENDER_FILM_IMAGE_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/canvas.h>
#include <oriel/base/error.h>

#include "render/film/film.h"

/*
 * PNG: 8 or 16 bits a channel, sRGB. Rows are filtered by Paeth's predictor and coded in runs
 * (zlib's Z_RLE). Compared to zlib's full search, a picture of a room is a fourth larger and takes
 * a fourth of the time. An error map is a fifteenth larger and takes a sixth.
 */

/* Writes a picture to path.part, then sync and rename. rgb: three bytes a pixel, from the top left,
 * row by row. Returns 0, ORL_ERR_IO or ORL_ERR_NOMEM. */
int orl_png_write(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                  struct orl_error *err);

/* Writes a picture with 16 bits a channel: two bytes each, the more significant one first.
 * Otherwise like orl_png_write. */
int orl_png_write_16(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                     struct orl_error *err);

/*
 * Animated PNG: frames of one size, 8 bits a channel, sRGB, each shown equally long, repeated for
 * ever. Programs that read only PNG show the first frame, or a poster.
 *
 * Rows are filtered and coded as in a still PNG. Chunks are written here over zlib, because libpng
 * has no animations: acTL after the header, an fcTL before each frame, the first one's pixels in
 * IDAT, the others' in fdAT. fcTL and fdAT chunks are numbered together. A poster is an IDAT before
 * the first fcTL.
 *
 * References: PNG, third edition (W3C 2025), 11.3.6 and 4.9; APNG 1.0 (Mozilla).
 */

struct orl_apng;

/* Creates a file. frames: their number, 1 or more; frame_s: seconds that each is shown, up to 65.
 * Returns 0, ORL_ERR_IO or ORL_ERR_NOMEM; close *ret_apng. */
int orl_apng_open(const char *path, uint32_t width, uint32_t height, uint32_t frames,
                  double frame_s, struct orl_apng **ret_apng, struct orl_error *err);

/* Writes the picture that programs without animation show, which is no frame; call it before the
 * first frame. Same arguments and errors as orl_apng_add. */
int orl_apng_put_poster(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err);

/* Writes the next frame: three bytes a pixel, from the top left, row by row. */
int orl_apng_add(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err);

/*
 * Writes the file if code is 0 and all frames are there (to path.part, then sync and rename). Frees
 * apng in any case; NULL is allowed. Returns code, ORL_ERR_IO, or ORL_ERR_INTERNAL if frames are
 * missing.
 */
int orl_apng_close(struct orl_apng *apng, int code, struct orl_error *err);

/*
 * OpenEXR files, by OpenEXRCore: scan lines from the top, ZIP, channels B, G and R as half or
 * float, W/sr/m2 each, no exposure. Values beyond the range of halves become ORL_EXR_LARGEST_HALF.
 *
 * Attributes: chromaticities (Radiance's primaries, white at 1/3, 1/3), whiteLuminance (179 cd/m2
 * of RGB 1, 1, 1), worldToCamera (scene units; rows times matrix; camera looks along -z, x to the
 * right, y up), pixelAspectRatio, screenWindowWidth of perspective views, and "radianceView", the
 * VIEW line.
 */

#define ORL_EXR_LARGEST_HALF 65504

/* Returns true if a pixel exceeds that, such as a sun. */
bool orl_exr_exceeds_halves(const struct orl_film *film);

/* Writes to path.part, then sync and rename. Returns 0, ORL_ERR_IO, ORL_ERR_FULL or
 * ORL_ERR_NOMEM. */
int orl_exr_write(const struct orl_film *film, const struct orl_view *view, bool halves,
                  const char *path, struct orl_error *err);

/*
 * Reads Radiance pictures into films (base/io/rgbe.h).
 *
 * The header's EXPOSUREs and COLORCORRs are divided out, so that pixels are W/sr/m2 again. The last
 * VIEW line is the picture's. XYZE is rejected. The input may be hostile.
 */

struct orl_hdr_picture {
    struct orl_film film; /* errors are unknown */
    struct orl_view view; /* valid if has_view */
    bool has_view;
};

/* Reads a picture. Returns 0 or ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT, _RANGE (an impossible view)
 * or _NOMEM, with the name in err. The caller releases the picture. */
int orl_hdr_read(const char *name, const void *data, size_t size,
                 struct orl_hdr_picture *ret_picture, struct orl_error *err);
void orl_hdr_done(struct orl_hdr_picture *picture);

/*
 * A page of PDF 1.4 (ISO 32000-1): polygons, lines, and text in fonts that every reader has
 * (Helvetica and Symbol). The file contains no date, so that equal calls give equal bytes.
 *
 * Frame: page units from the upper left corner, x to the right and y down, as in a canvas
 * (oriel/base/canvas.h).
 */

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
