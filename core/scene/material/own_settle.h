/* Materials' own functions, looked at over their surfaces before anything is rendered. */
#ifndef ORL_SCENE_MATERIAL_OWN_SETTLE_H
#define ORL_SCENE_MATERIAL_OWN_SETTLE_H

#include "scene/geometry/geometry.h"

/*
 * Fills in what lobes come to, warns, and refuses what would come out wrong: prisms that lead light
 * and eyes different ways, lobes that return more than they get. ORL_ERR_RANGE, _UNSUPPORTED, with
 * the place.
 */
int orl_own_settle(struct orl_description *description, const struct orl_geometry *geometry,
                   struct orl_error *err);

#endif
