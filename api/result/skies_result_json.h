/*
 * Results of a job of several skies -> JSON. Each sky has its own result (result_json.h, with its
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
#ifndef ORL_API_RESULT_SKIES_RESULT_JSON_H
#define ORL_API_RESULT_SKIES_RESULT_JSON_H

#include <jansson.h>

#include <oriel/job/run.h>

/* Encodes the result of one sky. */
json_t *orl_sky_result_to_json(const struct orl_result *result, const char *sky);

/* Begins the results of all skies. */
json_t *orl_skies_result_new(uint64_t seed, uint32_t threads);
/* Adds the result document of one sky, which is borrowed. Returns -1 when out of memory. */
int orl_skies_result_add(json_t *results, const json_t *sky_result);
/* Adds the state, last. */
int orl_skies_result_end(json_t *results, const char *state);

#endif
