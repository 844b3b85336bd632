/*
 * Coincident quadrics: spheres about one centre, cylinders about one axis that overlap along it,
 * cones with the same ends. Each kind is also compared with its inverted kind.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_QUADRICS_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_QUADRICS_H

#include "scene/geometry/coincidence/coplanar.h"

/* Adds the pairs, and counts comparisons, as orl_coplanar_find does. Returns 0 or ORL_ERR_NOMEM. */
int orl_concentric_find(const struct orl_parsed_scene *parsed_scene,
                        const struct orl_coincidence_scale *scale, struct orl_pairs *pairs,
                        struct orl_comparison_budget *budget);

#endif
