/*
 * Rows of a chunk of sensors: the product of coefficients (chunk_sums.h) with the skies and suns of
 * all hours, and direct sunlight.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H
#define ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H

#include "annual/year/annual_year.h"

enum orl_year_row { ORL_YEAR_TOTAL, ORL_YEAR_DIRECT, ORL_YEAR_SE, ORL_YEAR_ROWS };

static inline float *orl_year_row_of(const struct orl_year *y, size_t sensor, enum orl_year_row row)
{
    return y->rows + (sensor * ORL_YEAR_ROWS + row) * y->hours.n_columns;
}

/* Allocates memory for chunks of y->chunk sensors. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_chunk_rows_done in either case. */
int orl_chunk_rows_init(struct orl_year *y);
void orl_chunk_rows_done(struct orl_year *y);

/* Computes the rows of the current chunk. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_chunk_rows_compute(struct orl_year *y);
/* Computes the direct sunlight of a window group at a sensor, by column. */
void orl_chunk_direct_sunlight(const struct orl_year *y, size_t sensor, uint32_t window_group,
                               float *ret_lx);

/*
 * Chunks of a year's sensors as pieces of a distributed run (oriel/job/job_tasks.h). The store
 * holds the rows of each chunk. If rows cannot be shared, it holds their paths and the direct
 * sunlight at their sensors.
 */

/* Computes the current chunk (first, count), and stores it. */
typedef int orl_year_compute_chunk(struct orl_year *y, struct orl_error *err);

/* Returns the number of sensors per chunk: small enough to give each of a thousand processes
 * several chunks, at least 8 and at most `most`. Results do not depend on it. */
size_t orl_year_chunk_of_tasks(size_t n_sensors, size_t most);

/* Divides chunks among processes until the store has all of them. Chunks that cannot be stored are
 * computed later, chunk by chunk. */
int orl_year_run_chunk_tasks(struct orl_year *y, orl_year_compute_chunk *make,
                             struct orl_error *err);

/*
 * Processes a year's sensors chunk by chunk: paths, direct sunlight, and their products with the
 * skies and suns of all hours.
 */

/* Computes all sensors of a prepared year. Rows go into the result or to env->row. Returns 0,
 * ORL_ERR_NOMEM, _CANCELLED, or the error of a callback. */
int orl_year_run_chunks(struct orl_year *y, struct orl_error *err);
/* NULL and partly initialised years are allowed. */
void orl_year_chunks_done(struct orl_year *y);

#endif
