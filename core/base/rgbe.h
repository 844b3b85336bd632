/*
 * Radiance pictures as bytes: the lines of the header, one by one, and pixels as they are stored,
 * RGBE, flat or run-length encoded, by pixel (old) or by component (new).
 *
 * Any of the eight orders of scanlines is turned to ours: from the top left, row by row. What
 * header lines mean, but for the resolution, is the caller's.
 *
 * Bytes may be anybody's: sizes are bounded by limits.h before memory is asked for, and nothing is
 * read beyond the end. Reference: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's file
 * formats (filefmts).
 */
#ifndef ORL_BASE_RGBE_H
#define ORL_BASE_RGBE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_rgbe {
    const char *name; /* for errors; borrowed, as the bytes are */
    const unsigned char *at, *end;
    int line;                   /* of the header; 0 behind it */
    uint32_t scanlines, length; /* as they are stored */
    uint32_t width, height;     /* as they are seen */
    char order[4];              /* "-Y+X": signs and axes, the slower first */
};

/* Whether the bytes begin as a picture's do: with "#?", or with a header that tells a FORMAT of
 * 32-bit_rle_..., which is what Radiance asks for. */
bool orl_rgbe_is_one(const void *data, size_t size);

/* Takes a line of the header, "#?" and the last excepted; 0 or an error. */
typedef int (*orl_rgbe_line)(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                             struct orl_error *err);

/* Reads to where the pixels begin. ORL_ERR_SYNTAX, _LIMIT, or what take says. */
int orl_rgbe_begin(struct orl_rgbe *rgbe, const char *name, const void *data, size_t size,
                   orl_rgbe_line take, void *ctx, struct orl_error *err);

/* All pixels, width x height of them. ORL_ERR_SYNTAX, _NOMEM. */
int orl_rgbe_pixels(struct orl_rgbe *rgbe, unsigned char (*ret_pixels)[4], struct orl_error *err);

/* Sets what is wrong, where in the header. Returns code. */
int orl_rgbe_fail(const struct orl_rgbe *rgbe, int code, struct orl_error *err, const char *what);

/* The middle of what the bytes stand for, as Radiance's tools take them. */
static inline double orl_rgbe_value(const unsigned char pixel[4], int channel)
{
    return pixel[3] > 0 ? (pixel[channel] + 0.5) * ldexp(1, (int)pixel[3] - 136) : 0;
}

#endif
