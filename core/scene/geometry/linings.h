/*
 * Linings of antimatter (antimatter.h) where it is in doubt what is matter. What lies behind a
 * surface that shows its back is taken for matter, so a room whose surfaces look out of it is: the
 * lining would stand in that room and hold up light. Radiance's rays, which count what they enter,
 * meet no lining from within such a room.
 *
 * So a lining is left away, as if "void" stood for it, where windows in its volume look straight
 * on it on one side, and into the open on the other: what lies behind a window is no matter. Of
 * rooms without windows it is at least said, by the places of sensors and eyes (run/health.c).
 *
 * Threads: settled once, by one, before the geometry is shared or copied; then immutable.
 */
#ifndef ORL_SCENE_GEOMETRY_LININGS_H
#define ORL_SCENE_GEOMETRY_LININGS_H

#include "scene/geometry/geometry.h"

/* is_window: by material, whether light passes it. */
void orl_linings_settle(struct orl_geometry *geometry, const bool *is_window);

/* How many antimatters there are: 0 to this - 1 number them. */
size_t orl_linings_end(const struct orl_geometry *geometry);
/* Its material, and a facet of its volume's surface, for messages. */
void orl_lining_of(const struct orl_geometry *geometry, size_t antimatter, uint32_t *ret_material,
                   uint32_t *ret_facet);
/* Whether it was left away by orl_linings_settle. */
bool orl_lining_is_left_away(const struct orl_geometry *geometry, size_t antimatter);
/* Whether it has one, which takes that place (moved coordinates) for matter: surfaces that it cuts
 * show their backs all round. */
bool orl_lining_has_in_matter(const struct orl_geometry *geometry, size_t antimatter,
                              struct orl_vec3 place);

#endif
