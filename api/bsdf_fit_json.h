/*
 * A document that asks for a BSDF of measurements (JSON) -> struct orl_bsdf_fit_request, and what
 * was made of them -> JSON.
 *
 *     {"kind": "bsdf_fit", "measurements": {"files": ["t_0.txt", "t_15.txt"]} (or an id, as a job's
 *      scene), "name": "Prismatic film" (the data's, or the first file's, when left out),
 *      "basis": "tensor_tree_3", "tensor_tree_4", "klems_full", "klems_half" or "klems_quarter" (a
 *      tensor tree of rank 3 if isotropic, else of rank 4, when left out),
 *      "symmetry": "auto" (the default), "isotropic", "quadrilateral", "left_right", "up_down",
 *      "half_turn" or "none",
 *      "resolution": 64, "cull": 0.02 (of tensor trees alone),
 *      "reversed": false, "keep_outliers": false, "grazing": 0 (degrees)}
 *
 * What was made: {"kind", "basis", "symmetry", "rows", "components": {"transmission_front":
 * {"diffuse":
 * {"value", "error"}, "misplaced", "theta_most_deg"} or null, ...}, "scans": [{"component",
 * "theta_deg", "phi_deg", "rows", "outliers", "knots", "covered", "hidden_deg", "noise", "total":
 * {"value", "standard_error"}, "peak": {"value", "theta_deg", "phi_deg"}, "left_out": {"predicted",
 * "misplaced"} or null}], "outliers": {"count", "told": [{"file", "line", "value", "around"}]},
 * "color_left_out"}. Front is the surface's, where z > 0, the inside: not what the XML calls Front.
 *
 * Rules, ownership, threads and errors as in job_json.h. What they mean: oriel/bsdf_fit.h.
 */
#ifndef ORL_API_BSDF_FIT_JSON_H
#define ORL_API_BSDF_FIT_JSON_H

#include <jansson.h>

#include <oriel/bsdf_fit.h>

#include "job_json.h"

/* origin and ret_scene_id as in orl_job_from_json. What is checked is each value by itself: the
 * rest is orl_bsdf_fit_validate's. */
int orl_bsdf_fit_from_json(const json_t *doc, enum orl_job_origin origin,
                           struct orl_bsdf_fit_request *ret_request, char **ret_scene_id,
                           struct orl_error *err);

/* What files of measurements hold: {"rows", "incident_directions", "sample": text or null}. A new
 * reference; NULL when out of memory. */
json_t *orl_bsdf_measurements_to_json(const struct orl_bsdf_measurements *measurements);

/* Likewise, in sentences: what is not as it should be. */
json_t *orl_bsdf_fitted_warnings(const struct orl_bsdf_fitted *fitted);

/* Files by their names in the request. A new reference, the caller's; NULL when out of memory. */
json_t *orl_bsdf_fitted_to_json(const struct orl_bsdf_fit_request *request,
                                const struct orl_bsdf_fitted *fitted);

#endif
