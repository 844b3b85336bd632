/* A wave of a shared job (sharing.h): manages its parts from their files to their ends. */
#ifndef ORL_PARTS_WAVE_H
#define ORL_PARTS_WAVE_H

#include "parts/sharing.h"

/* Makes the pieces by parts, as a new wave. */
int orl_wave_run(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                 struct orl_error *err);

/*
 * Waits for waves that an earlier run left, and restarts their lost parts. Sets ret_made for
 * the pieces that their parts have made.
 */
int orl_wave_adopt(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                   bool *ret_made, struct orl_error *err);

#endif
