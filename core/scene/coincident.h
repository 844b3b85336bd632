/*
 * Polygons that lie in one place: which of them light meets, settled before anything is built.
 *
 * The rule is Radiance's (rayreject): what has a material beats what has none, what lets no light
 * through beats glass, trans and the like, a front beats a back, and of those still alike the one
 * whose modifier was defined later wins. Where one polygon loses from both sides it is cut away:
 * its outline leaves out the winner's, and a warning names both. Where two face opposite ways, as
 * walls of neighbouring rooms do, each is met from its front: they stay whole, and are listed for
 * geometry.c to choose by the side a ray comes from; that is no ambiguity, and not warned about.
 *
 * "One place" is within 1e-6 of the files' unit, Radiance's, or what rays can tell apart, 2^-21 of
 * the scene's size. Round surfaces are not looked at, nor are BSDFs that stand for geometry.
 * Work is bounded; what is left when it is used up is said.
 */
#ifndef ORL_SCENE_COINCIDENT_H
#define ORL_SCENE_COINCIDENT_H

#include <oriel/error.h>

#include "scene/description.h"

/* Changes outlines, drops surfaces, adds warnings and opposed pairs. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_coincident_settle(struct orl_description *description, struct orl_error *err);

#endif
