/*
 * Animated PNG: frames of one size, 8 bits a channel, sRGB, each shown as long, over and over. What
 * reads only PNG shows the first, or a poster.
 *
 * Rows are filtered and coded as png.h has it. Written here chunk by chunk over zlib, since libpng
 * has no animations: acTL after the header, an fcTL before each frame, the first one's pixels in
 * IDAT, the others' in fdAT; the chunks of both kinds are numbered together. A poster is an IDAT
 * before the first fcTL.
 *
 * References: PNG, third edition (W3C 2025), 11.3.6 and 4.9; APNG 1.0 (Mozilla).
 */
#ifndef ORL_RENDER_FILM_APNG_H
#define ORL_RENDER_FILM_APNG_H

#include <stdint.h>

#include <oriel/error.h>

struct orl_apng;

/* frames: how many there will be, 1 or more; frame_s: how long each is shown, up to 65 s. Returns
 * 0, ORL_ERR_IO or ORL_ERR_NOMEM; *ret_apng is to be closed. */
int orl_apng_open(const char *path, uint32_t width, uint32_t height, uint32_t frames,
                  double frame_s, struct orl_apng **ret_apng, struct orl_error *err);

/* What is shown by whatever reads only PNG, and is no frame: before the first. As a frame. */
int orl_apng_put_poster(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err);

/* The next frame: three bytes a pixel, from the top left, row by row. */
int orl_apng_add(struct orl_apng *apng, const unsigned char *rgb, struct orl_error *err);

/* Writes the file when code is 0 and all frames are there (to path.part, then sync and rename);
 * frees in any case. Returns code, ORL_ERR_IO, or ORL_ERR_INTERNAL: frames are missing. NULL is
 * fine. */
int orl_apng_close(struct orl_apng *apng, int code, struct orl_error *err);

#endif
