/*
 * A scene cut by a plane: where its surfaces go through it, as straight pieces. Round surfaces are
 * cut as prisms of 32 sides. The cut lies a hair's breadth before the plane, so that what stands on
 * it is cut, and what lies in it is not.
 */
#ifndef ORL_RENDER_HEAT_MAP_SECTION_H
#define ORL_RENDER_HEAT_MAP_SECTION_H

#include "render/heat_map/planes.h"
#include "scene/geometry/geometry.h"

/* Called for each piece, in the plane's axes. */
typedef void (*orl_section_piece)(void *ctx, const double from[2], const double to[2]);

void orl_section_cut(const struct orl_geometry *geometry, const struct orl_sensor_plane *plane,
                     orl_section_piece piece, void *ctx);

#endif
