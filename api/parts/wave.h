/* A wave of a shared job (sharing.h): its parts, from their files to their ends. */
#ifndef ORL_PARTS_WAVE_H
#define ORL_PARTS_WAVE_H

#include "parts/sharing.h"

/* Has these pieces made by parts, as a wave of its own. */
int orl_wave_run(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                 struct orl_error *err);

/*
 * Waits for waves that an earlier run has left, and has made what is lost of them. Sets ret_made of
 * those of the pieces that their parts were to make: they are made.
 */
int orl_wave_adopt(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                   bool *ret_made, struct orl_error *err);

#endif
