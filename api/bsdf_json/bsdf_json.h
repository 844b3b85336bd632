/*
 * Contents of an uploaded BSDF -> JSON: {"name", "kind", "resolution", "values", "bytes",
 * "components": {"reflection_front", "reflection_back", "transmission_front",
 * "transmission_back"}, "dummy": {"transmission_front", "transmission_back": null, "zero" or
 * "copy"}, "max_albedo": {"front", "back"}, "thickness_m", "colored", "clamped"}. Front is the
 * side to which a Radiance surface's normal points; the XML has front and back exchanged. Returns
 * a new reference, owned by the caller, or NULL when out of memory.
 */
#ifndef ORL_API_BSDF_JSON_BSDF_JSON_H
#define ORL_API_BSDF_JSON_BSDF_JSON_H

#include <jansson.h>

#include <oriel/bsdf/bsdf_polar.h>

json_t *orl_bsdf_info_to_json(const struct orl_bsdf_info *info);

/*
 * Contents and check of a BSDF: all of the above, and "check": {"verdict", "verdicts": [{"level",
 * "text"}], "hemispherical": {"front", "back": [{"theta_deg", "phi_deg", "reflected",
 * "transmitted"}]}, "extremes", "irreciprocal", "straight_through", "redirection"};
 * oriel/bsdf/bsdf.h defines each term, api/openapi.yaml its form.
 */
json_t *orl_bsdf_check_to_json(const struct orl_bsdf_check *check);

/*
 * Distribution of the light from one incident direction: {"from": "front" or "back", "theta_deg",
 * "phi_deg", "reflected", "transmitted", "straight", "reflection": [[...], ...], "transmission"}.
 * Rows are by theta (oriel/bsdf/bsdf_polar.h).
 */
json_t *orl_bsdf_polar_to_json(const struct orl_bsdf_polar *polar, bool front, double theta_deg,
                               double phi_deg);

#endif
