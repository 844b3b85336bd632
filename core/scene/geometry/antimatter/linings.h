/*
 * Linings of antimatter (antimatter.h) where matter is ambiguous. The space behind a surface that
 * shows its back counts as matter. So a room whose surfaces face outwards is matter: the lining
 * would appear inside the room and block light. Radiance's rays, which count the volumes they
 * enter, meet no lining from within such a room.
 *
 * So a lining is omitted, as if it were "void", where windows in its volume face it on one side,
 * and open space on the other. The space behind a window is not matter. Rooms without windows only
 * get a warning, by the places of sensors and eyes (run/diagnostics/health_warnings.c).
 *
 * Threads: settled once, by one thread, before the geometry is shared or copied; then immutable.
 */
#ifndef ORL_SCENE_GEOMETRY_ANTIMATTER_LININGS_H
#define ORL_SCENE_GEOMETRY_ANTIMATTER_LININGS_H

#include "scene/geometry/geometry.h"

/* is_window: by material, true if light passes it. */
void orl_linings_resolve(struct orl_geometry *geometry, const bool *is_window);

/* Returns the number of antimatters; their indices are 0 to this - 1. */
size_t orl_linings_count(const struct orl_geometry *geometry);
/* Returns its material, and a facet of its volume's surface, for messages. */
void orl_lining_of(const struct orl_geometry *geometry, size_t antimatter, uint32_t *ret_material,
                   uint32_t *ret_facet);
/* Returns true if orl_linings_resolve omitted the lining. */
bool orl_lining_is_omitted(const struct orl_geometry *geometry, size_t antimatter);
/* Returns true if it has a lining for which that place (moved coordinates) counts as matter:
 * surfaces that it cuts show their backs all round. */
bool orl_lining_matter_contains(const struct orl_geometry *geometry, size_t antimatter,
                                struct orl_vec3 place);

#endif
