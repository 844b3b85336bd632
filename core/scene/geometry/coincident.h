/*
 * Polygons that lie in one place: which of them light meets, settled before anything is built.
 *
 * The rule is Radiance's (rayreject): what has a material beats what has none, what lets no light
 * through beats glass, trans and the like, a front beats a back, and of those still alike the one
 * whose modifier was defined later wins. Where one polygon loses from both sides it is cut away
 * (cutting.h): its outline leaves out the winner's. Where two face opposite ways, as walls of
 * neighbouring rooms do, each is met from its front: they stay whole, and are listed for geometry.c
 * to choose by the side a ray comes from.
 *
 * All that is said (coincident_words.h), but where nothing hangs on it: of one material it is
 * counted, and of one that is alike on both sides it does not matter which way they face.
 *
 * "One place" is within 1e-6 of the files' unit, Radiance's, or what rays can tell apart, 2^-21 of
 * the scene's size. Round surfaces and rings, and BSDFs that stand for geometry and look the same
 * way, are left as they are: rays meet either, and a warning says so. Exact duplicates are dropped
 * first (duplicates.h), in n log n. Work on pairs is bounded in proportion to the scene's corners;
 * what is left when it is used up is said.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENT_H
#define ORL_SCENE_GEOMETRY_COINCIDENT_H

#include <oriel/error.h>

#include "scene/description.h"

/* Changes outlines, drops surfaces, adds warnings and opposed pairs. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_coincident_settle(struct orl_description *description, struct orl_error *err);

#endif
