/*
 * Rays that leave the scene from a side of a window or an opening, with every surface taken as
 * opaque: they tell which side is outside.
 */
#ifndef ORL_LIGHT_ESCAPE_H
#define ORL_LIGHT_ESCAPE_H

#include "base/random.h"
#include "scene/geometry/geometry.h"

/* Fills ret_shares with the shares of rays that leave from the front and from the back of one of
 * the scene's own facets, in directions by the cosine; fewer rays are sent where those are clear.
 */
void orl_escape_shares(const struct orl_geometry *geometry, uint32_t facet, uint32_t rays,
                       struct orl_random *random, double ret_shares[2]);

/* Returns true if so many rays of each side, of which so many have left, tell enough: where a
 * quarter of one side's leave and none of the other's, the other side's share is a quarter of that
 * with a probability of 1e-7 at most. */
static inline bool orl_escape_is_clear(const uint32_t left[2], uint32_t rays)
{
    const uint32_t more = left[0] > left[1] ? left[0] : left[1];
    return rays >= 256 && more >= rays / 4 && (left[0] == 0 || left[1] == 0);
}

/* Returns true if the side with the larger share is outside, and the other one is not: panes that
 * stand free see open space from both sides. */
bool orl_escape_tells(const double shares[2]);

#endif
