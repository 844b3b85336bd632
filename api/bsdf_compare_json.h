/*
 * What two BSDFs differ by -> JSON: {"front": {"reflected": {"albedo": {"rms", "worst", "from":
 * {"theta_deg", "phi_deg"}}, "cone_2deg": {"worst", "from", "to"}, "moved": {"mean", "worst",
 * "from"}}, "transmitted": {...}}, "back": {...}}. Shares of the light that comes
 * (oriel/bsdf_convert.h).
 */
#ifndef ORL_API_BSDF_COMPARE_JSON_H
#define ORL_API_BSDF_COMPARE_JSON_H

#include <jansson.h>

#include <oriel/bsdf_convert.h>

/* A new reference, the caller's; NULL when out of memory. */
json_t *orl_bsdf_comparison_to_json(const struct orl_bsdf_comparison *comparison);

#endif
