/* A year's sensors chunk by chunk: paths, direct sunlight, and the rows of all hours. */
#ifndef ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H
#define ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H

#include "annual/year/annual_year.h"

enum orl_year_row { ORL_YEAR_TOTAL, ORL_YEAR_DIRECT, ORL_YEAR_SE, ORL_YEAR_ROWS };

static inline float *orl_year_row_of(const struct orl_year *y, size_t sensor, enum orl_year_row row)
{
    return y->chunk.rows + (sensor * ORL_YEAR_ROWS + row) * y->hours.n_columns;
}

/* Allocates memory for chunks of y->chunk.size sensors. Returns 0 or ORL_ERR_NOMEM. */
int orl_chunk_rows_init(struct orl_year *y);

/* Computes the rows of the current chunk. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_chunk_rows_compute(struct orl_year *y);
/* Computes the direct sunlight of a window group at a sensor, by column. */
void orl_chunk_direct_sunlight(const struct orl_year *y, size_t sensor, uint32_t window_group,
                               float *ret_lx);

/* Computes all sensors of a prepared year. Rows go into the result or to env->row. Returns 0,
 * ORL_ERR_NOMEM, _CANCELLED, or the error of a callback. */
int orl_year_run_chunks(struct orl_year *y, struct orl_error *err);

#endif
