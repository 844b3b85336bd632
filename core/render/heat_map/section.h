/*
 * Cuts a scene by a plane into straight segments. Round surfaces are cut as prisms of 32 sides. The
 * cut lies slightly in front of the plane, so that objects standing on it are cut, and surfaces in
 * it are not.
 */
#ifndef ORL_RENDER_HEAT_MAP_SECTION_H
#define ORL_RENDER_HEAT_MAP_SECTION_H

#include "render/heat_map/planes.h"
#include "scene/geometry/geometry.h"

/* Callback for each segment, in the plane's axes. */
typedef void (*orl_section_segment)(void *ctx, const double from[2], const double to[2]);

void orl_section_cut(const struct orl_geometry *geometry, const struct orl_sensor_plane *plane,
                     orl_section_segment piece, void *ctx);

#endif
