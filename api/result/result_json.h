/*
 * Results in JSON: result.json of a job and of a job with several skies, photon maps, and summaries
 * of scenes. api/schema/result.yaml describes them.
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
 * name as "sky") in a file <sky>.json. SkiesResult of api/schema/result.yaml describes the results
 * of all skies.
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
