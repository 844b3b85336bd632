/*
 * Summary of an uploaded scene -> JSON: {"surfaces", "materials", "sources", "triangles", "bsdfs",
 * "bounds": {"min": [x, y, z], "max": [x, y, z]}, "digest", "referenced": ["lcp.xml", ...]}.
 * Functions return a new reference, owned by the caller, or NULL when out of memory.
 */
#ifndef ORL_API_RESULT_SCENE_JSON_H
#define ORL_API_RESULT_SCENE_JSON_H

#include <jansson.h>

#include <oriel/job/floor_plan.h>

json_t *orl_scene_summary_to_json(const struct orl_scene_summary *summary);

/* Encodes a floor plan: {"height", "bounds", "lines": [[x, y, x, y], ...], "more"}. */
json_t *orl_floor_plan_to_json(const struct orl_floor_plan *plan);

#endif
