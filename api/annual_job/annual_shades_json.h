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
 *                            or {"by": "dgp", "seats": [...] (annual_glare_json.h), "above": 0.4,
 *                             "state": "blinds"}}]
 *
 * By default, a control closes the group to its second state. In result.json:
 *
 *     "shades": null or {"runs", "summed" (the groups' light was added), "groups": [{"name", "by",
 *     "states": [{"name", "hours" (with light in the weather file), "occupied_hours"}]}]}
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_SHADES_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_SHADES_JSON_H

#include "annual_job/annual_json.h"

/* Decoder (members.h) into a struct orl_annual_request. */
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

#endif
