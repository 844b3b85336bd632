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
#ifndef ORL_API_BSDF_JSON_BSDF_MAKE_JSON_H
#define ORL_API_BSDF_JSON_BSDF_MAKE_JSON_H

#include <jansson.h>

#include <oriel/bsdf/bsdf_make.h>

#include "job/job_json.h"

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

#endif
