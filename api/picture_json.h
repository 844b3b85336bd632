/*
 * Pictures of a view: what a job document asks for, and how results tell of them.
 *
 *     "formats": ["hdr", "png", "png16", "exr", "exr_float"]
 *     "display": {"tone": "human", "veil": true, "acuity": true, "color_loss": true}
 *                {"tone": "linear"}   {"exposure": 0.5}   {"ev": 9}
 *     "false_color": {"scale": 2000 or "auto", "decades": 2, "divisions": 8, "palette": "even",
 *                     "label": "cd/m2", "multiplier": 179, "isolines": true, "extrema": true,
 *                     "draw": ["fill", "lines", "bands"],
 *                     "points": [{"name": "desk", "x": 20, "y": 30}]}
 */
#ifndef ORL_API_PICTURE_JSON_H
#define ORL_API_PICTURE_JSON_H

#include <jansson.h>

#include <oriel/run.h>

/* Reads the three members of a view's object; path is the view's. What is absent changes nothing.
 * The points are owned by the view, also when this fails. */
int orl_pictures_from_json(const json_t *view, const char *path, struct orl_view_request *request,
                           struct orl_error *err);

/*
 * A job's "heat_map": {"scale", "decades", "divisions", "palette": as above, "thresholds": [300],
 * "length_unit": "m"}; NULL: absent, nothing changes.
 */
int orl_heat_map_from_json(const json_t *value, struct orl_heat_map_request *request,
                           struct orl_error *err);

/* {"csv", "res", "maps": [{"png", "svg", "dat" of a full grid, "sensors"}]}; NULL: there are none,
 * or no memory. */
json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files);

/* Adds the names of the files to a result's view, and what false colours have found:
 *     "hdr": "a.hdr", ..., "scale": 2000, "points": [{"name": "desk", "value": 310}]
 * Nonzero: out of memory. */
int orl_pictures_to_json(const struct orl_view_result *view, json_t *json);

/* The same read back, into a view that has none of it; its strings are owned. False: out of memory,
 * with what is there to be freed. */
bool orl_pictures_read_back(const json_t *json, struct orl_view_result *view);

#endif
