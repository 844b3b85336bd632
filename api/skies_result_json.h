/*
 * Results of a job of several skies -> JSON. Each sky has a result of its own (result_json.h, with
 * "sky", its name), in a file <sky>.json; all of them together are
 *
 *     {"state", "threads", "seed", "timings_s" (sums), "skies": [
 *          {"name", "file", "dark", "technique", "seconds", "illuminance_lx": [...],
 *           "views": as in the sky's result, "accuracy" likewise}],
 *      "warnings": each that a sky's result has, once}
 *
 * What is returned is a new reference, the caller's; NULL when out of memory.
 */
#ifndef ORL_API_SKIES_RESULT_JSON_H
#define ORL_API_SKIES_RESULT_JSON_H

#include <jansson.h>

#include <oriel/run.h>

/* The result of one sky. */
json_t *orl_sky_result_to_json(const struct orl_result *result, const char *sky);

/* The results of all, gathered from those of each: begins ... */
json_t *orl_skies_result_new(uint64_t seed, uint32_t threads);
/* ... adds one, from its document, which is borrowed: -1 when out of memory ... */
int orl_skies_result_add(json_t *results, const json_t *sky_result);
/* ... and the state comes last. */
int orl_skies_result_end(json_t *results, const char *state);

#endif
