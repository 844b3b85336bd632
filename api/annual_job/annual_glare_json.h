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
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_GLARE_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_GLARE_JSON_H

#include <jansson.h>

#include <oriel/annual/annual_report.h>

/* Decoder (members.h) into a struct orl_viewpoint_request. */
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
