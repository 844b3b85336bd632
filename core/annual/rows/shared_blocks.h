/*
 * Blocks of a year's sensors as pieces of a distributed run (oriel/pieces.h). The store holds the
 * rows of each block. If rows cannot be shared, it holds their paths and the direct sunlight at
 * their sensors.
 */
#ifndef ORL_ANNUAL_ROWS_SHARED_BLOCKS_H
#define ORL_ANNUAL_ROWS_SHARED_BLOCKS_H

#include "annual/year/annual_year.h"

/* Computes the current block (first, count), and stores it. */
typedef int orl_year_make_block(struct orl_year *y, struct orl_error *err);

/* Returns the number of sensors per block: small enough to give each of a thousand processes
 * several blocks, at least 8 and at most `most`. Results do not depend on it. */
size_t orl_year_shared_block(size_t n_sensors, size_t most);

/* Divides blocks among processes until the store has all of them. Blocks that cannot be stored are
 * computed later, block by block. */
int orl_year_share_blocks(struct orl_year *y, orl_year_make_block *make, struct orl_error *err);

#endif
