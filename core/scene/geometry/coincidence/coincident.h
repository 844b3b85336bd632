/*
 * Coincident polygons: decides which of them rays hit, before geometry is built.
 *
 * The rule is Radiance's (rayreject). A surface with a material wins over one without; opaque
 * materials win over glass, trans and the like; a front wins over a back; then the modifier that
 * was defined later wins. A polygon that loses from both sides is cut (cutting.h): the winner's
 * outline is subtracted from its own. Two that face opposite ways, as walls of neighbouring rooms
 * do, are each hit from their front: they stay whole, and are listed for geometry.c to choose by
 * the side that a ray comes from.
 *
 * All this is reported (coincidence_warnings.h), except where it has no effect: pairs of one
 * material are only counted, and for two-sided materials the orientation does not matter.
 *
 * Surfaces coincide within 1e-6 of the files' unit, as in Radiance, or within what rays can
 * resolve, 2^-21 of the scene's size. Quadrics and rings, and BSDFs that stand for geometry and
 * face the same way, are left as they are: rays hit either, and a warning says so. Exact duplicates
 * are dropped first (duplicates.h), in n log n. Work on pairs is bounded in proportion to the
 * scene's corners; a warning reports what remains.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_H

#include <oriel/base/error.h>

#include "scene/parsed_scene.h"

/* Changes outlines, drops surfaces, adds warnings and opposed pairs. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_coincident_resolve(struct orl_parsed_scene *parsed_scene, struct orl_error *err);

#endif
