/*
 * A job's sensors in grids:
 *
 *     "grids": [{"name": "desks", "sensors": {"file": "grid/desks.pts"} or [[x, y, z, dx, dy, dz],
 * ...]}]
 *
 * in place of "sensors", and what came of them in the result: "grids": [{"name", "first", "count",
 * "res", "npy"}], files by name, first among "sensors".
 */
#ifndef ORL_API_GRIDS_JSON_H
#define ORL_API_GRIDS_JSON_H

#include <jansson.h>

#include <oriel/run.h>

/* An orl_json_decoder into struct orl_job; what was read before an error stays there. */
int orl_grids_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);

/* A new reference; NULL: there are none, or no memory. */
json_t *orl_grids_to_json(const struct orl_result *result);

#endif
