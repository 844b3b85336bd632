/*
 * A job's sensors in grids:
 *
 *     "grids": [{"name": "desks", "sensors": {"file": "grid/desks.pts"} or [[x, y, z, dx, dy, dz],
 *               ...]}]
 *
 * in place of "sensors". The result has "grids": [{"name", "first", "count", "res", "npy"}]: first
 * is an index in "sensors", res and npy are file names.
 */
#ifndef ORL_API_JOB_GRIDS_JSON_H
#define ORL_API_JOB_GRIDS_JSON_H

#include <jansson.h>

#include <oriel/job/run.h>

/* Decoder (members.h) into a struct orl_job; sensors and grids read before an error stay there. */
int orl_grids_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);

/* Returns a new reference, or NULL if there are no grids or no memory. */
json_t *orl_grids_to_json(const struct orl_result *result);

#endif
