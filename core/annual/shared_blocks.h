/*
 * Blocks of a year's sensors as pieces of a year that is shared (oriel/pieces.h): the rows of each
 * lie in the store, or what takes time of them, paths and the sun straight to its sensors.
 */
#ifndef ORL_ANNUAL_SHARED_BLOCKS_H
#define ORL_ANNUAL_SHARED_BLOCKS_H

#include "annual/year.h"

/* Makes the block at hand (first, count), and keeps it. */
typedef int orl_year_make_block(struct orl_year *y, struct orl_error *err);

/* Sensors of a block: so few that a thousand parts find some each, and no more than one run has at
 * a time (most, at least 8). Results do not depend on it. */
size_t orl_year_shared_block(size_t n_sensors, size_t most);

/* Until the store has all blocks. What cannot be kept is made later, block by block. */
int orl_year_share_blocks(struct orl_year *y, orl_year_make_block *make, struct orl_error *err);

#endif
