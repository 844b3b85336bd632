/*
 * BSDFs in JSON: contents and check of a BSDF, the light scattered from one direction, differences
 * of two BSDFs, and the documents and results of bsdf_make and bsdf_fit.
 *
 * Front is the side to which a Radiance surface's normal points; the XML has front and back
 * exchanged.
 */
#ifndef ORL_API_BSDF_JSON_BSDF_JSON_H
#define ORL_API_BSDF_JSON_BSDF_JSON_H

#include <jansson.h>

#include <oriel/bsdf/bsdf_convert.h>
#include <oriel/bsdf/bsdf_fit.h>
#include <oriel/bsdf/bsdf_make.h>
#include <oriel/bsdf/bsdf_polar.h>

#include "job/job_json.h"

/*
 * Contents of an uploaded BSDF -> JSON: {"name", "kind", "resolution", "values", "bytes",
 * "components": {"reflection_front", "reflection_back", "transmission_front",
 * "transmission_back"}, "dummy": {"transmission_front", "transmission_back": null, "zero" or
 * "copy"}, "max_albedo": {"front", "back"}, "thickness_m", "colored", "clamped"}. Returns a new
 * reference, owned by the caller, or NULL when out of memory. The same holds for the functions
 * below.
 */
json_t *orl_bsdf_info_to_json(const struct orl_bsdf_info *info);

/*
 * Contents and check of a BSDF: all of the above, and "check": {"verdict", "verdicts": [{"level",
 * "text"}], "hemispherical": {"front", "back": [{"theta_deg", "phi_deg", "reflected",
 * "transmitted"}]}, "extremes", "irreciprocal", "straight_through", "redirection"};
 * oriel/bsdf/bsdf.h defines each term, api/schema its form.
 */
json_t *orl_bsdf_check_to_json(const struct orl_bsdf_check *check);

/*
 * Distribution of the light from one incident direction: {"from": "front" or "back", "theta_deg",
 * "phi_deg", "reflected", "transmitted", "straight", "reflection": [[...], ...], "transmission"}.
 * Rows are by theta (oriel/bsdf/bsdf_polar.h).
 */
json_t *orl_bsdf_polar_to_json(const struct orl_bsdf_polar *polar, bool front, double theta_deg,
                               double phi_deg);

/*
 * Differences of two BSDFs -> JSON: {"front": {"reflected": {"albedo": {"rms", "worst", "from":
 * {"theta_deg", "phi_deg"}}, "cone_2deg": {"worst", "from", "to"}, "moved": {"mean", "worst",
 * "from"}}, "transmitted": {...}}, "back": {...}}. Values are fractions of the incident light
 * (oriel/bsdf/bsdf_convert.h).
 */

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_bsdf_comparison_to_json(const struct orl_bsdf_comparison *comparison);

/*
 * A request to compute a panel's BSDF (JSON) -> struct orl_bsdf_make_request, and the result ->
 * JSON.
 *
 * api/schema/bsdf_jobs.yaml describes the document, and api/schema/result_bsdf.yaml the result. For
 * tensor trees, "directions" is empty and standard errors are null. Front is the surface's front:
 * z > 0, the inside. The XML calls that side Back.
 *
 * Rules, ownership, threads and errors as in job_json.h. oriel/bsdf/bsdf_make.h defines the terms.
 */

/* Decodes doc; origin and ret_scene_id as in orl_job_from_json. It checks each value by itself;
 * orl_bsdf_make_validate checks the rest. */
int orl_bsdf_make_from_json(const json_t *doc, enum orl_job_origin origin,
                            struct orl_bsdf_make_request *ret_request, char **ret_scene_id,
                            struct orl_error *err);

/* Returns ORL_ERR_INVALID if doc has members for tensor trees but basis is another. */
int orl_bsdf_check_tree_members(const json_t *doc, enum orl_bsdf_basis basis,
                                struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_bsdf_made_to_json(const struct orl_bsdf_make_result *made);
/* Returns an array of sentences about what differs from the request or is doubtful: a new
 * reference, or NULL when out of memory. */
json_t *orl_bsdf_made_warnings(const struct orl_bsdf_make_result *made,
                               const struct orl_bsdf_make_request *request);

/*
 * A request to fit a BSDF to measurements (JSON) -> struct orl_bsdf_fit_request, and the result ->
 * JSON.
 *
 * api/schema/bsdf_jobs.yaml describes the document, and api/schema/result_bsdf.yaml the result.
 *
 * Rules, ownership, threads and errors as in job_json.h. oriel/bsdf/bsdf_fit.h defines the terms.
 */

/* Decodes doc; origin and ret_scene_id as in orl_job_from_json. It checks each value by itself;
 * orl_bsdf_fit_validate checks the rest. */
int orl_bsdf_fit_from_json(const json_t *doc, enum orl_job_origin origin,
                           struct orl_bsdf_fit_request *ret_request, char **ret_scene_id,
                           struct orl_error *err);

/* Summary of measurement files: {"rows", "incident_directions", "sample": text or null}. Returns a
 * new reference or NULL when out of memory. */
json_t *orl_bsdf_measurements_to_json(const struct orl_bsdf_measurements *measurements);

/* Returns the fit's problems as an array of sentences: a new reference, or NULL when out of
 * memory. */
json_t *orl_bsdf_fitted_warnings(const struct orl_bsdf_fit_result *fitted);

/* Returns a new reference, owned by the caller, or NULL when out of memory. Files have the names
 * that the request has. */
json_t *orl_bsdf_fitted_to_json(const struct orl_bsdf_fit_request *request,
                                const struct orl_bsdf_fit_result *fitted);

#endif
