/*
 * Maps and tables of sensors. A job's
 *
 *     "heat_map": {"scale", "decades", "divisions", "palette": as in picture_json.h,
 *                  "thresholds": [300], "length_unit": "m"}
 *
 * and a result's {"csv", "res", "maps": [{"png", "svg", "dat" of a full grid, "sensors"}]}.
 */
#ifndef ORL_API_HEAT_MAP_JSON_H
#define ORL_API_HEAT_MAP_JSON_H

#include <oriel/run.h>

#include "members.h"

/* Into a struct orl_heat_map_request. */
orl_json_decoder orl_heat_map_from_json;

/* A new reference; NULL: there are none, or no memory. */
json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files);

#endif
