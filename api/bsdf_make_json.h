/*
 * A document that asks for a panel's BSDF (JSON) -> struct orl_bsdf_make_request, and what was made
 * -> JSON.
 *
 *     {"kind": "bsdf_make", "scene": {"files": ["panel.rad"]} (or an id, as in a job),
 *      "name": "Laser cut panel" (the first file's when left out),
 *      "basis": "klems_full" (the default), "klems_half", "klems_quarter", "tensor_tree_3" or
 *      "tensor_tree_4",
 *      "resolution": 64, "cull": 0.05 (of tensor trees alone),
 *      "color": true (X and Z beside Y, u' and v' of trees; false),
 *      "cell": {"x": [0, 1], "y": [0, 0.02]} (the box around the panel when left out),
 *      "symmetry": "none" (the default), "left_right", "up_down" or "both",
 *      "paths": 16384 (an incident direction; by the basis when left out),
 *      "accuracy": 0.02, "paths_most": 1048576 (of one direction, only with an accuracy),
 *      "seed": 1}
 *
 * What was made: {"kind", "diffuse": {"front": {"reflected": {"value", "standard_error"},
 * "transmitted": {...}}, "back": {...}}, "directions": [{"theta_deg", "phi_deg", "front", "back"}],
 * "standard_errors": {"transmission_front": [[...], ...] (a row for each direction in, 1/sr),
 * "transmission_back", "reflection_front", "reflection_back"}, "worst_relative_error",
 * "joined_relative_error", "reached", "paths", "lost", "cell": {"x", "y", "z"}}. Of tensor trees
 * there are no directions, and their standard errors are null. Front is the surface's, where z > 0,
 * the inside: not what the XML calls Front.
 *
 * Rules, ownership, threads and errors as in job_json.h. What they mean: oriel/bsdf_make.h.
 */
#ifndef ORL_API_BSDF_MAKE_JSON_H
#define ORL_API_BSDF_MAKE_JSON_H

#include <jansson.h>

#include <oriel/bsdf_make.h>

#include "job_json.h"

/* origin and ret_scene_id as in orl_job_from_json. What is checked is each value by itself: the
 * rest is orl_bsdf_make_validate's. */
int orl_bsdf_make_from_json(const json_t *doc, enum orl_job_origin origin,
                            struct orl_bsdf_make_request *ret_request, char **ret_scene_id,
                            struct orl_error *err);

/* What is of tensor trees alone, in a document of another basis, is ORL_ERR_INVALID. */
int orl_bsdf_check_tree_members(const json_t *doc, enum orl_bsdf_basis basis,
                                struct orl_error *err);

/* A new reference, the caller's; NULL when out of memory. */
json_t *orl_bsdf_made_to_json(const struct orl_bsdf_made *made);
/* Likewise, in sentences: what is not as it was asked for, or not as it should be. */
json_t *orl_bsdf_made_warnings(const struct orl_bsdf_made *made,
                               const struct orl_bsdf_make_request *request);

#endif
