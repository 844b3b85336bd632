/*
 * Glare in a year's document, and in its result (oriel/annual_glare.h has what it means).
 *
 *     "glare": {"seats": [{"name": "desk" (by default "seat" and its number), "at": [x, y, z] (the
 *                          eye), "towards": [dx, dy, dz]}, ...]}
 *
 * result.json has
 *
 *     "glare": null or {"seats": [{"name", "above": [{"dgp": 0.35, "percent", "interval_95"},
 *     the same of 0.4 and 0.45] (of the time of use), "exceeded_5": {"dgp", "interval_95"} (what
 * DGP is above in 5 % of it), "protection": "none", "minimum", "medium", "high" or "undecided",
 *     "worst": [{"month", "day", "hour", "dgp", "interval_95", "eye_lx"}] (of several days the
 *     worst hours, for pictures)}],
 *     "autonomy": {"percent", "interval_95"} (spatial glare autonomy: of seats)}
 *
 * and glare.csv every lit hour of use.
 */
#ifndef ORL_API_ANNUAL_GLARE_H
#define ORL_API_ANNUAL_GLARE_H

#include <jansson.h>

#include <oriel/annual_report.h>

/* A decoder of members.h; into: a struct orl_seats_wish. */
int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err);

/* Its array of seats alone; into: the same. */
int orl_seats_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);

/* A new reference, the caller's; NULL when out of memory. */
json_t *orl_annual_glare_to_json(const struct orl_seats_wish *wish,
                                 const struct orl_annual_result *result,
                                 const struct orl_annual_report *report);

#endif
