/*
 * Coincident quadrics: spheres about one centre, cylinders about one axis that overlap along it,
 * cones with the same ends. Each kind is also compared with its inverted kind.
 */
#ifndef ORL_SCENE_GEOMETRY_CONCENTRIC_H
#define ORL_SCENE_GEOMETRY_CONCENTRIC_H

#include "scene/geometry/coplanar.h"

/* Adds the pairs, and counts comparisons, as orl_coplanar_find does. Returns 0 or ORL_ERR_NOMEM. */
int orl_concentric_find(const struct orl_description *description,
                        const struct orl_same_place *place, struct orl_pairs *pairs,
                        struct orl_looks *looks);

#endif
