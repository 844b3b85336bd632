/*
 * Matrices of other programs in a year's document, in place of path tracing.
 * oriel/annual/annual_matrices.h defines them.
 *
 *     "matrices": [{"grid": "desks" (by default all sensors),
 *                   "view": "v.mtx", "transmission": "blinds.xml" or "t.mtx", "daylight": "d.mtx",
 *                   or "coefficients": "dc.mtx",
 *                   "sky": "year.smx", "subtract": false}, ...]
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_MATRICES_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_MATRICES_JSON_H

#include <jansson.h>

#include <oriel/annual/annual.h>

/* Decoder (members.h) into a struct orl_annual_request. */
int orl_annual_matrices_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

#endif
