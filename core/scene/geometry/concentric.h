/*
 * Round surfaces in one place: spheres about one center, cylinders about one axis that overlap
 * along it, cones from end to end alike; each with its own kind turned inside out.
 */
#ifndef ORL_SCENE_GEOMETRY_CONCENTRIC_H
#define ORL_SCENE_GEOMETRY_CONCENTRIC_H

#include "scene/geometry/coplanar.h"

/* Adds the pairs, and counts looks, as orl_coplanar_find does. Returns 0 or ORL_ERR_NOMEM. */
int orl_concentric_find(const struct orl_description *description,
                        const struct orl_same_place *place, struct orl_pairs *pairs,
                        struct orl_looks *looks);

#endif
