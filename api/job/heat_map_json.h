/*
 * Maps and tables of sensors. A job has
 *
 *     "heat_map": {"scale", "decades", "divisions", "palette": as in picture_json.h,
 *                  "thresholds": [300], "length_unit": "m"}
 *
 * and a result has {"csv", "res", "maps": [{"png", "svg", "dat" (for a full grid), "sensors"}]}.
 */
#ifndef ORL_API_JOB_HEAT_MAP_JSON_H
#define ORL_API_JOB_HEAT_MAP_JSON_H

#include <oriel/job/run.h>

#include "json/members.h"

/* Decoder (members.h) into a struct orl_heat_map_request. */
orl_json_decoder orl_heat_map_from_json;

/* Returns a new reference, or NULL if there are no files or no memory. */
json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files);

#endif
