/* Animated PNG from still PNGs of one size. */
#ifndef ORIEL_JOB_ANIMATION_H
#define ORIEL_JOB_ANIMATION_H

#include <stddef.h>

#include <oriel/base/error.h>

/* Writes the animation; on errors no file is left. frame_s: seconds per frame. Returns 0,
 * ORL_ERR_RANGE (pictures differ in size), ORL_ERR_IO, _NOMEM or _SYNTAX. */
int orl_animation_write(const char *const *pictures, size_t count, double frame_s, const char *path,
                        struct orl_error *err);

#endif
