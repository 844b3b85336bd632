/*
 * Animated PNG: frames of one size, 8 bits a channel, sRGB, each shown equally long, repeated for
 * ever. Programs that read only PNG show the first frame, or a poster.
 *
 * Rows are filtered and coded as in png.h. Chunks are written here over zlib, because libpng has no
 * animations: acTL after the header, an fcTL before each frame, the first one's pixels in IDAT, the
 * others' in fdAT. fcTL and fdAT chunks are numbered together. A poster is an IDAT before the first
 * fcTL.
 *
 * References: PNG, third edition (W3C 2025), 11.3.6 and 4.9; APNG 1.0 (Mozilla).
 */
#ifndef ORL_RENDER_FILM_APNG_H
#define ORL_RENDER_FILM_APNG_H

#include <stdint.h>

#include <oriel/base/error.h>

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

#endif
