/*
 * Where a sensor stands: one written down as lying on a surface, or a tenth of a millimetre under
 * it, is to look away from it, not at it, and stays where it is otherwise. What is clear of a
 * surface depends on that surface: ground wider than a town must not lift the sensors of a room by
 * a millimetre, out of the edge of a shadow.
 */
#ifndef ORL_SCENE_GEOMETRY_STAND_H
#define ORL_SCENE_GEOMETRY_STAND_H

#include "scene/geometry/geometry.h"

/* Where rays of a sensor at that (moved) point start; normal, unit, is the way it faces. */
struct orl_vec3 orl_stand(const struct orl_geometry *geometry, struct orl_vec3 point,
                          struct orl_vec3 normal);

/* The nearest surface on which a point lies, as far as can be told: the geometry's resolution. */
struct orl_touch {
    uint32_t facet;
    double distance;
};

/* Returns false when the point is clear of all surfaces. */
bool orl_touches_surface(const struct orl_geometry *geometry, struct orl_vec3 point,
                         struct orl_touch *ret_touch);

#endif
