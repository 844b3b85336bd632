/*
 * Results in JSON: result.json of a job and of a job with several skies, photon maps, and summaries
 * of scenes. Members of result.json, also in the job document:
 *
 *     {"state", "threads", "seed", "plan": {...} or null (job_members_json.h),
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

#include <oriel/job/floor_plan.h>
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

/*
 * Results of a job of several skies -> JSON. Each sky has its own result (as above, with its
 * name as "sky") in a file <sky>.json. The results of all skies are
 *
 *     {"state", "threads", "seed", "timings_s" (sums), "skies": [
 *          {"name", "file", "dark", "technique", "seconds", "illuminance_lx": [...],
 *           "views": as in the sky's result, "accuracy": likewise}],
 *      "warnings": those of all skies, each once}
 *
 * Functions that return JSON return a new reference, owned by the caller, or NULL when out of
 * memory.
 */

/* Encodes the result of one sky. */
json_t *orl_sky_result_to_json(const struct orl_result *result, const char *sky);

/* Begins the results of all skies. */
json_t *orl_skies_result_new(uint64_t seed, uint32_t threads);
/* Adds the result document of one sky, which is borrowed. Returns -1 when out of memory. */
int orl_skies_result_add(json_t *results, const json_t *sky_result);
/* Adds the state, last. */
int orl_skies_result_end(json_t *results, const char *state);

/*
 * Summary of an uploaded scene -> JSON: {"surfaces", "materials", "sources", "triangles", "bsdfs",
 * "bounds": {"min": [x, y, z], "max": [x, y, z]}, "digest", "referenced": ["lcp.xml", ...]}.
 * Functions return a new reference, owned by the caller, or NULL when out of memory.
 */

json_t *orl_scene_summary_to_json(const struct orl_scene_summary *summary);

/* Encodes a floor plan: {"height", "bounds", "lines": [[x, y, x, y], ...], "more"}. */
json_t *orl_floor_plan_to_json(const struct orl_floor_plan *plan);

#endif
