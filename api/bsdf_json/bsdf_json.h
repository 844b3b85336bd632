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
 *     {"kind": "bsdf_make", "scene": {"files": ["panel.rad"]} (or an id, as in a job),
 *      "name": "Laser cut panel" (the first file's when left out),
 *      "basis": "klems_full" (the default), "klems_half", "klems_quarter", "tensor_tree_3" or
 *      "tensor_tree_4",
 *      "resolution": 64, "cull": 0.05 (for tensor trees only),
 *      "color": true (X and Z beside Y, u' and v' in trees; default false),
 *      "cell": {"x": [0, 1], "y": [0, 0.02]} (the box around the panel when left out),
 *      "symmetry": "none" (the default), "left_right", "up_down" or "both",
 *      "paths": 16384 (per incident direction; by default from the basis),
 *      "accuracy": 0.02, "paths_most": 1048576 (per direction, only with an accuracy),
 *      "seed": 1}
 *
 * The result: {"kind", "diffuse": {"front": {"reflected": {"value", "standard_error"},
 * "transmitted": {...}}, "back": {...}}, "directions": [{"theta_deg", "phi_deg", "front",
 * "back"}], "standard_errors": {"transmission_front": [[...], ...] (a row for each direction in,
 * 1/sr), "transmission_back", "reflection_front", "reflection_back"}, "worst_relative_error",
 * "joined_relative_error", "reached", "paths", "lost", "cell": {"x", "y", "z"}}. For tensor trees,
 * "directions" is empty and standard errors are null. Front is the surface's front: z > 0, the
 * inside. The XML calls that side Back.
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
 *     {"kind": "bsdf_fit", "measurements": {"files": ["t_0.txt", "t_15.txt"]} (or an id, as a job's
 *      scene), "name": "Prismatic film" (the data's, or the first file's, when left out),
 *      "basis": "tensor_tree_3", "tensor_tree_4", "klems_full", "klems_half" or "klems_quarter" (a
 *      tensor tree of rank 3 if isotropic, else of rank 4, when left out),
 *      "symmetry": "auto" (the default), "isotropic", "quadrilateral", "left_right", "up_down",
 *      "half_turn" or "none",
 *      "resolution": 64, "cull": 0.02 (for tensor trees only),
 *      "reversed": false, "keep_outliers": false, "grazing": 0 (degrees)}
 *
 * The result: {"kind", "basis", "symmetry", "rows", "components": {"transmission_front":
 * {"diffuse": {"value", "error"}, "misplaced", "theta_most_deg"} or null, ...}, "scans":
 * [{"component", "theta_deg", "phi_deg", "rows", "outliers", "knots", "covered", "hidden_deg",
 * "noise", "total": {"value", "standard_error"}, "peak": {"value", "theta_deg", "phi_deg"},
 * "left_out": {"predicted", "misplaced"} or null}], "outliers": {"count", "told": [{"file",
 * "line", "value", "around"}]}, "color_left_out"}. Front is the surface's front: z > 0, the
 * inside. The XML calls that side Back.
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
