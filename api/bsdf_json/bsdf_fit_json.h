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
#ifndef ORL_API_BSDF_JSON_BSDF_FIT_JSON_H
#define ORL_API_BSDF_JSON_BSDF_FIT_JSON_H

#include <jansson.h>

#include <oriel/bsdf/bsdf_fit.h>

#include "job/job_json.h"

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
