/*
 * Members of a year's document and of its result: grids, matrices, shades, exposure to sunlight,
 * view out and glare. annual_json.h has the document's format, rules and errors.
 *
 * annual_grids_json.c and annual_shades_json.c have grids and shades, annual_members_json.c the
 * other members.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_MEMBERS_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_MEMBERS_JSON_H

#include <jansson.h>

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_report.h>

#include "annual_job/annual_json.h"

/* Decodes scene, grids and sensors of doc after all its other members are decoded. The caller
 * frees what job owns, also after an error. */
int orl_annual_grids_from_json(const json_t *doc, enum orl_job_origin origin,
                               struct orl_annual_job *job, char **ret_scene_id,
                               struct orl_error *err);

/*
 * Matrices of other programs in a year's document, in place of path tracing.
 * oriel/annual/annual.h defines them.
 *
 *     "matrices": [{"grid": "desks" (by default all sensors),
 *                   "view": "v.mtx", "transmission": "blinds.xml" or "t.mtx", "daylight": "d.mtx",
 *                   or "coefficients": "dc.mtx",
 *                   "sky": "year.smx", "subtract": false}, ...]
 */

/* Decoder (decode.h) into a struct orl_annual_request. */
int orl_annual_matrices_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/*
 * Shades in a year's document and in its result. oriel/annual/annual_shades.h defines the terms.
 *
 *     "shades": [{"name": "south", "windows": ["south_glass", ...] (names or modifiers),
 *                 "states": [{"name": "open"}, {"name": "blinds", "files": ["blinds.rad", ...],
 *                             "material": "lcp", "dark": false}, ...],
 *                 one of, or none:
 *                 "schedule": [0, 1, ...] (a state per row of the weather file),
 *                             or {"file": "shades.csv"} (with their names, or numbers),
 *                 "rules": [{"months": [5, 9], "from": 10, "to": 16, "state": "blinds"}, ...],
 *                 "control": {"by": "LM-83" or "sun" or "illuminance", "grid": "eyes",
 *                             "above": 1000 (lx), "share": 2 (%, by sun), "state": "blinds"}
 *                            or {"by": "dgp", "seats": [...] (as in "glare"), "above": 0.4,
 *                             "state": "blinds"}}]
 *
 * By default, a control closes the group to its second state. In result.json:
 *
 *     "shades": null or {"runs", "summed" (the groups' light was added), "groups": [{"name", "by",
 *     "states": [{"name", "hours" (with light in the weather file), "occupied_hours"}]}]}
 */

/* Decoder (decode.h) into a struct orl_annual_request. */
int orl_annual_shades_from_json(const json_t *value, const char *path, void *into,
                                struct orl_error *err);

/* Hours with light that a group spends in a state: all, and those in use. */
struct orl_state_hours {
    double lit, occupied;
};
/* Fills in the hours of each state of a group. The year must have shades. */
void orl_annual_state_hours(const struct orl_annual_result *result,
                            const struct orl_annual_report *report, size_t group,
                            struct orl_state_hours ret_hours[ORL_SHADES_MOST_STATES]);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_shades_to_json(const struct orl_annual_request *request,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_report *report);
/* Returns the shades' settings as requested, without series; ownership as above. */
json_t *orl_annual_shades_settings(const struct orl_annual_request *request);

/*
 * Exposure to sunlight in a year's document and in its result. oriel/annual/sun_exposure.h defines
 * the terms.
 *
 *     "exposure": {"points": [{"name": "living room" (by default "point" and its number),
 *                              "at": [x, y, z]}, ...], "least_altitude": 0 (degrees)}
 *
 * In result.json:
 *
 *     "exposure": null or {"least_altitude", "points": [{"name", "hours", "month", "day" (the
 *     sunniest), "last_day_hours" (21 March or September), "level": "none", "minimum", "medium" or
 *     "high"}]}
 */

/* Decoder (decode.h) into a struct orl_exposure_request. */
int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_exposure_to_json(const struct orl_exposure_request *exposure_request,
                                    const struct orl_annual_report *report);

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

/* Decoder (decode.h) into a struct orl_view_out_request. */
int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_view_out_to_json(const struct orl_view_out_request *view_out_request,
                                    const struct orl_annual_report *report);

/*
 * Glare in a year's document and in its result. oriel/annual/annual_glare.h defines the terms.
 *
 *     "glare": {"seats": [{"name": "desk" (by default "seat" and its number), "at": [x, y, z] (the
 *                          eye), "towards": [dx, dy, dz]}, ...]}
 *
 * In result.json:
 *
 *     "glare": null or {"seats": [{"name", "above": [{"dgp": 0.35, "percent", "interval_95"},
 *     likewise for 0.4 and 0.45] (% of the time of use), "exceeded_5": {"dgp", "interval_95"} (DGP
 *     exceeded in 5 % of it), "protection": "none", "minimum", "medium", "high" or "undecided",
 *     "worst": [{"month", "day", "hour", "dgp", "interval_95", "eye_lx"}] (the worst hours of
 *     several days, for pictures)}],
 *     "autonomy": {"percent", "interval_95"} (spatial glare autonomy: % of seats)}
 *
 * glare.csv has every lit hour of use.
 */

/* Decoder (decode.h) into a struct orl_viewpoint_request. */
int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err);

/* Decoder of the "seats" array alone into a struct orl_viewpoint_request. */
int orl_viewpoints_from_json(const json_t *value, const char *path, void *into,
                             struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_glare_to_json(const struct orl_viewpoint_request *viewpoint_request,
                                 const struct orl_annual_result *result,
                                 const struct orl_annual_report *report);

#endif
