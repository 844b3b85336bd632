/* Pictures one after the other: an animated PNG of PNGs of one size. */
#ifndef ORIEL_ANIMATION_H
#define ORIEL_ANIMATION_H

#include <stddef.h>

#include <oriel/error.h>

/* frame_s: how long each is shown. Whole or absent. ORL_ERR_RANGE: they differ in size;
 * ORL_ERR_IO, _NOMEM, _SYNTAX. */
int orl_animation_write(const char *const *pictures, size_t count, double frame_s, const char *path,
                        struct orl_error *err);

#endif
