/*
 * Rays that leave the scene from a side of a window or an opening, with every surface taken as
 * opaque: they tell which side is outside.
 */
#ifndef ORL_LIGHT_ESCAPE_H
#define ORL_LIGHT_ESCAPE_H

#include "base/random.h"
#include "scene/geometry/geometry.h"

/* Returns the share of rays that leave, of those from points of that side of one of the scene's own
 * facets, in directions by the cosine. */
double orl_escape_share(const struct orl_geometry *geometry, uint32_t facet, bool front,
                        uint32_t rays, struct orl_random *random);

/* Returns true if the side with the larger share is outside, and the other one is not: panes that
 * stand free see open space from both sides. */
bool orl_escape_tells(const double shares[2]);

#endif
