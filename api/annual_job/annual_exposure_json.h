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
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_EXPOSURE_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_EXPOSURE_JSON_H

#include <jansson.h>

#include <oriel/annual/annual_report.h>

/* Decoder (members.h) into a struct orl_exposure_request. */
int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_exposure_to_json(const struct orl_exposure_request *exposure_request,
                                    const struct orl_annual_report *report);

#endif
