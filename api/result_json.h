/*
 * Results and photon maps -> JSON, as result.json and the job document hold them:
 *
 *     {"state", "threads", "seed", "plan": {...} or null (plan_json.h),
 *      "timings_s": {"load", "bvh", "plan", "photons", "maps", "render", "total"},
 *      "maps": [{"kind", "key", "emitted", "stored", "reused", "bytes", "seconds", "cached"}],
 *      "sensors": [{"illuminance_lx", "standard_error_lx", "bias_estimate_lx",
 *                   "interval_95_lx": [low, high], "unreliable": [...]}],
 *      "views": [{"name", "hdr", "png", "error_hdr" and "error_png" where errors are known,
 *                 "seconds"}], "health": {...}, "warnings": ["..."],
 *      "dark" of a job with a sky: whether that gives no light,
 *      "accuracy": {"asked", "met", "achieved", "rounds", "why",
 *                   "course": [{"seconds", "error"}]} of a job with a goal,
 *      "cost": {"seconds": as timings_s, "rays", "photons",
 *               "next": {"error", "halve_s", "one_percent_s", "model"}}}
 *
 * Returned objects are new references, the caller's; NULL when out of memory.
 */
#ifndef ORL_API_RESULT_JSON_H
#define ORL_API_RESULT_JSON_H

#include <jansson.h>

#include <oriel/run.h>

/* state: "succeeded", "failed", ... A result that orl_run did not fill in may be all zeros. */
json_t *orl_result_to_json(const struct orl_result *result, const char *state);

/* A result of orl_plan_job: {"plan": {...}, "warnings": ["..."], "curve": {"technique", "threads",
 * "points": [{"seconds", "error"}], "model"} or, of NULL, null}. */
json_t *orl_planned_to_json(const struct orl_result *result, const struct orl_curve *curve);

/* How a job with a goal ended, or stands; NULL without one. */
json_t *orl_outcome_to_json(const struct orl_outcome *outcome);

/* One map: kind, key, emitted, stored, reused, bytes, seconds, cached. */
json_t *orl_map_info_to_json(const struct orl_map_info *info);

#endif
