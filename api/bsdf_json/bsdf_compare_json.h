/*
 * Differences of two BSDFs -> JSON: {"front": {"reflected": {"albedo": {"rms", "worst", "from":
 * {"theta_deg", "phi_deg"}}, "cone_2deg": {"worst", "from", "to"}, "moved": {"mean", "worst",
 * "from"}}, "transmitted": {...}}, "back": {...}}. Values are fractions of the incident light
 * (oriel/bsdf/bsdf_convert.h).
 */
#ifndef ORL_API_BSDF_JSON_BSDF_COMPARE_JSON_H
#define ORL_API_BSDF_JSON_BSDF_COMPARE_JSON_H

#include <jansson.h>

#include <oriel/bsdf/bsdf_convert.h>

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_bsdf_comparison_to_json(const struct orl_bsdf_comparison *comparison);

#endif
