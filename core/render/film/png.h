/*
 * PNG: 8 or 16 bits a channel, sRGB. Rows are filtered by Paeth's predictor and coded in runs
 * (zlib's Z_RLE). Compared to zlib's full search, a picture of a room is a fourth larger and takes
 * a fourth of the time. An error map is a fifteenth larger and takes a sixth.
 */
#ifndef ORL_RENDER_FILM_PNG_H
#define ORL_RENDER_FILM_PNG_H

#include <stdint.h>

#include <oriel/base/error.h>

/* Writes a picture to path.part, then sync and rename. rgb: three bytes a pixel, from the top left,
 * row by row. Returns 0, ORL_ERR_IO or ORL_ERR_NOMEM. */
int orl_png_write(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                  struct orl_error *err);

/* Writes a picture with 16 bits a channel: two bytes each, the more significant one first.
 * Otherwise like orl_png_write. */
int orl_png_write_16(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                     struct orl_error *err);

#endif
