/*
 * Offsets of sensors from surfaces. A sensor on a surface, or up to a tenth of a millimetre below
 * it, is moved in front of it; other sensors stay where they are. The offset depends on that
 * surface only: a ground wider than a town must not lift the sensors of a room by a millimetre,
 * across the edge of a shadow.
 */
#ifndef ORL_SCENE_GEOMETRY_SURFACE_OFFSET_H
#define ORL_SCENE_GEOMETRY_SURFACE_OFFSET_H

#include "scene/geometry/geometry.h"

/* Returns the origin of a sensor's rays for that (moved) point; normal, unit, is its viewing
 * direction. */
struct orl_vec3 orl_offset_from_surface(const struct orl_geometry *geometry, struct orl_vec3 point,
                                        struct orl_vec3 normal);

/* The nearest surface that a point touches within the geometry's resolution. */
struct orl_surface_contact {
    uint32_t facet;
    double distance;
};

/* Returns false if the point is clear of all surfaces. */
bool orl_find_surface_contact(const struct orl_geometry *geometry, struct orl_vec3 point,
                              struct orl_surface_contact *ret_touch);

#endif
