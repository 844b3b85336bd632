/*
 * Rows of a block of sensors: the product of coefficients (block_sums.h) with the skies and suns of
 * all hours, and direct sunlight.
 */
#ifndef ORL_ANNUAL_ROWS_BLOCK_ROWS_H
#define ORL_ANNUAL_ROWS_BLOCK_ROWS_H

#include "annual/year/annual_year.h"

enum orl_year_row { ORL_YEAR_TOTAL, ORL_YEAR_DIRECT, ORL_YEAR_SE, ORL_YEAR_ROWS };

static inline float *orl_year_row_of(const struct orl_year *y, size_t sensor, enum orl_year_row row)
{
    return y->rows + (sensor * ORL_YEAR_ROWS + row) * y->hours.n_columns;
}

/* Allocates memory for blocks of y->block sensors. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_block_rows_done in either case. */
int orl_block_rows_init(struct orl_year *y);
void orl_block_rows_done(struct orl_year *y);

/* Computes the rows of the current block. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_block_rows_make(struct orl_year *y);
/* Computes the direct sunlight of a part at a sensor, by column. */
void orl_block_direct(const struct orl_year *y, size_t sensor, uint32_t part, float *ret_lx);

#endif
