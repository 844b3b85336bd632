/*
 * Processes a year's sensors chunk by chunk: paths, direct sunlight, and their products with the
 * skies and suns of all hours.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H
#define ORL_ANNUAL_COEFFICIENTS_SENSOR_CHUNKS_H

#include "annual/year/annual_year.h"

/* Computes all sensors of a prepared year. Rows go into the result or to env->row. Returns 0,
 * ORL_ERR_NOMEM, _CANCELLED, or the error of a callback. */
int orl_year_run_chunks(struct orl_year *y, struct orl_error *err);
/* NULL and partly initialised years are allowed. */
void orl_year_chunks_done(struct orl_year *y);

#endif
