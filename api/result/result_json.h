/*
 * Results and photon maps -> JSON, as in result.json and the job document:
 *
 *     {"state", "threads", "seed", "plan": {...} or null (plan_json.h),
 *      "timings_s": {"load", "bvh", "plan", "photons", "maps", "render", "total"},
 *      "maps": [{"kind", "key", "emitted", "stored", "reused", "bytes", "seconds", "cached"}],
 *      "sensors": [{"illuminance_lx", "standard_error_lx", "bias_estimate_lx",
 *                   "interval_95_lx": [low, high], "unreliable": [...]}],
 *      "views": [{"name", "hdr", "png", "error_hdr" and "error_png" where errors are known,
 *                 "seconds"}], "health": {...}, "warnings": ["..."],
 *      "dark" (for a job with a sky): true if the sky gives no light,
 *      "accuracy": {"asked", "met", "achieved", "rounds", "why",
 *                   "course": [{"seconds", "error"}]} for a job with a goal,
 *      "cost": {"seconds": as timings_s, "rays", "photons",
 *               "next": {"error", "halve_s", "one_percent_s", "model"}}}
 *
 * Functions return new references, owned by the caller, or NULL when out of memory.
 */
#ifndef ORL_API_RESULT_RESULT_JSON_H
#define ORL_API_RESULT_RESULT_JSON_H

#include <jansson.h>

#include <oriel/job/run.h>

/* Encodes a result. state: "succeeded", "failed", ... result may be all zeros if orl_run did not
 * fill it in. */
json_t *orl_result_to_json(const struct orl_result *result, const char *state);

/* Encodes a result of orl_plan_job: {"plan": {...}, "warnings": ["..."], "curve": {"technique",
 * "threads", "points": [{"seconds", "error"}], "model"}}. "curve" is null if curve is NULL. */
json_t *orl_planned_to_json(const struct orl_result *result,
                            const struct orl_accuracy_curve *curve);

/* Encodes the final or current outcome of a job with a goal; NULL without a goal. */
json_t *orl_outcome_to_json(const struct orl_outcome *outcome);

/* Encodes one map: kind, key, emitted, stored, reused, bytes, seconds, cached. */
json_t *orl_map_info_to_json(const struct orl_map_info *info);

#endif
