/*
 * Reads Radiance pictures: the header line by line, and pixels in RGBE, flat or run-length encoded,
 * by pixel (old) or by component (new).
 *
 * All eight orders of scanlines are converted to one: from the top left, row by row. The caller
 * interprets the header lines, except for the resolution.
 *
 * Data may be untrusted: sizes are bounded by limits.h before memory is allocated, and nothing is
 * read beyond the end. References: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's file
 * formats (filefmts).
 */
#ifndef ORL_BASE_IO_RGBE_H
#define ORL_BASE_IO_RGBE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

struct orl_rgbe {
    const char *name; /* for errors; borrowed, as is the data */
    const unsigned char *at, *end;
    int line;                   /* current header line; 0 after the header */
    uint32_t scanlines, length; /* dimensions as stored */
    uint32_t width, height;     /* dimensions as displayed */
    char order[4];              /* "-Y+X": signs and axes, the slower first */
};

/* Returns true if the data begin as a picture: with "#?", or with a header whose FORMAT is
 * 32-bit_rle_..., which is the check of Radiance. */
bool orl_is_rgbe(const void *data, size_t size);

/* Handles a header line other than "#?" and the last. Returns 0 or an error. */
typedef int (*orl_rgbe_line)(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                             struct orl_error *err);

/* Reads the header up to the first pixel. Returns 0, ORL_ERR_SYNTAX, _LIMIT, or the error of
 * `take`. */
int orl_rgbe_begin(struct orl_rgbe *rgbe, const char *name, const void *data, size_t size,
                   orl_rgbe_line take, void *ctx, struct orl_error *err);

/* Reads all width x height pixels. Returns 0, ORL_ERR_SYNTAX or _NOMEM. */
int orl_rgbe_pixels(struct orl_rgbe *rgbe, unsigned char (*ret_pixels)[4], struct orl_error *err);

/* Sets an error with the header line. Returns code. */
int orl_rgbe_fail(const struct orl_rgbe *rgbe, int code, struct orl_error *err, const char *what);

/* Returns the middle of the interval that the bytes represent, as in Radiance's tools. */
static inline double orl_rgbe_value(const unsigned char pixel[4], int channel)
{
    return pixel[3] > 0 ? (pixel[channel] + 0.5) * ldexp(1, (int)pixel[3] - 136) : 0;
}

#endif
