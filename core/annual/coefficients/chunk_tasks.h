/*
 * Chunks of a year's sensors as pieces of a distributed run (oriel/job/job_tasks.h). The store
 * holds the rows of each chunk. If rows cannot be shared, it holds their paths and the direct
 * sunlight at their sensors.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_CHUNK_TASKS_H
#define ORL_ANNUAL_COEFFICIENTS_CHUNK_TASKS_H

#include "annual/year/annual_year.h"

/* Computes the current chunk (first, count), and stores it. */
typedef int orl_year_compute_chunk(struct orl_year *y, struct orl_error *err);

/* Returns the number of sensors per chunk: small enough to give each of a thousand processes
 * several chunks, at least 8 and at most `most`. Results do not depend on it. */
size_t orl_year_chunk_of_tasks(size_t n_sensors, size_t most);

/* Divides chunks among processes until the store has all of them. Chunks that cannot be stored are
 * computed later, chunk by chunk. */
int orl_year_run_chunk_tasks(struct orl_year *y, orl_year_compute_chunk *make,
                             struct orl_error *err);

#endif
