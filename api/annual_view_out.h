/*
 * View out in a year's document, and in its result (oriel/view_out.h has what it means).
 *
 *     "view_out": {"points": [{"name": "desk" (by default "point" and its number),
 *                              "at": [x, y, z]}, ...],
 *                  "above_sensors": 0.4 (m: also from so far above every sensor),
 *                  "openings": ["clear_glass", ...] (surfaces or modifiers; by default all of
 * glass), "ground": ["lawn", ...] (likewise; by default the lowest that is level)}
 *
 * At least one of points and above_sensors. result.json has
 *
 *     "view_out": null or {"points": [{"name", "sight_angle" (degrees), "distance" (m; null:
 * without end), "layers": ["sky", "landscape", "ground"], "level": "none", "minimum", "medium" or
 *     "high"}], "grids": [{"grid", "shares": {"minimum", "medium", "high"} (% of the area that
 *     reach so much), "level" (what 75 % of the area reach)}] (none without above_sensors)}
 */
#ifndef ORL_API_ANNUAL_VIEW_OUT_H
#define ORL_API_ANNUAL_VIEW_OUT_H

#include <jansson.h>

#include <oriel/annual_report.h>

/* A decoder of members.h; into: a struct orl_view_out_wish. */
int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* A new reference, the caller's; NULL when out of memory. */
json_t *orl_annual_view_out_to_json(const struct orl_view_out_wish *wish,
                                    const struct orl_annual_report *report);

#endif
