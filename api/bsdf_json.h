/*
 * What an uploaded BSDF holds -> JSON: {"name", "kind", "resolution", "values", "bytes",
 * "components": {"reflection_front", "reflection_back", "transmission_front",
 * "transmission_back"}, "dummy": {"transmission_front",
 * "transmission_back": null, "zero" or "copy"}, "max_albedo": {"front", "back"}, "thickness_m",
 * "colored", "clamped"}. Front and back are those of a Radiance surface (front: the side its normal
 * points to), which is the other way round in the XML. A new reference, the caller's; NULL when out
 * of memory.
 */
#ifndef ORL_API_BSDF_JSON_H
#define ORL_API_BSDF_JSON_H

#include <jansson.h>

#include <oriel/bsdf_polar.h>

json_t *orl_bsdf_info_to_json(const struct orl_bsdf_info *info);

/*
 * The same with its check: all of the above, and "check": {"verdict", "verdicts": [{"level",
 * "text"}], "hemispherical": {"front", "back": [{"theta_deg", "phi_deg", "reflected",
 * "transmitted"}]}, "extremes", "irreciprocal", "straight_through", "redirection"}; oriel/bsdf.h
 * says what each means, api/openapi.yaml how each looks.
 */
json_t *orl_bsdf_check_to_json(const struct orl_bsdf_check *check);

/*
 * Where light from one direction goes: {"from": "front" or "back", "theta_deg", "phi_deg",
 * "reflected", "transmitted", "straight", "reflection": [[...], ...], "transmission"}, rows of
 * theta (oriel/bsdf_polar.h).
 */
json_t *orl_bsdf_polar_to_json(const struct orl_bsdf_polar *polar, bool front, double theta_deg,
                               double phi_deg);

#endif
