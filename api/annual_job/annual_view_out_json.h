/*
 * View out in a year's document and in its result. oriel/annual/view_out.h defines the terms.
 *
 *     "view_out": {"points": [{"name": "desk" (by default "point" and its number),
 *                              "at": [x, y, z]}, ...],
 *                  "above_sensors": 0.4 (m; adds points this far above every sensor),
 *                  "openings": ["clear_glass", ...] (surfaces or modifiers; by default all
 *                  glass), "ground": ["lawn", ...] (likewise; by default the
 *                  lowest horizontal ones)}
 *
 * At least one of points and above_sensors is required. In result.json:
 *
 *     "view_out": null or {"points": [{"name", "sight_angle" (degrees), "distance" (m; null:
 *     infinite), "layers": ["sky", "landscape", "ground"], "level": "none", "minimum", "medium" or
 *     "high"}], "grids": [{"grid", "shares": {"minimum", "medium", "high"} (% of the area
 *     that reaches each), "level" (that 75 % of the area reaches)}] (none without above_sensors)}
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_VIEW_OUT_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_VIEW_OUT_JSON_H

#include <jansson.h>

#include <oriel/annual/annual_report.h>

/* Decoder (members.h) into a struct orl_view_out_request. */
int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_view_out_to_json(const struct orl_view_out_request *view_out_request,
                                    const struct orl_annual_report *report);

#endif
