/* Tests of material functions over their surfaces, before rendering. */
#ifndef ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_CHECK_H
#define ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_CHECK_H

#include "scene/geometry/geometry.h"

/*
 * Stores the integrals of lobes, warns, and refuses materials that would give wrong results: prisms
 * whose ways differ between light and eye, lobes with an albedo above 1. Returns 0, or
 * ORL_ERR_RANGE or _UNSUPPORTED with file and line; ORL_ERR_LIMIT (too many such materials),
 * _CANCELLED or _NOMEM.
 */
int orl_function_brdf_check(struct orl_parsed_scene *parsed_scene,
                            const struct orl_geometry *geometry, struct orl_error *err);

#endif
