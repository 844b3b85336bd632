/*
 * Shares of rays that leave the scene from either side of a window or an opening, with every
 * surface taken as opaque. They show which side is outside.
 */
#ifndef ORL_SCENE_BUILT_ESCAPE_H
#define ORL_SCENE_BUILT_ESCAPE_H

#include "base/sampling/random.h"
#include "scene/geometry/geometry.h"

/* Fills ret_shares with the shares of rays that leave from the front and from the back of one of
 * the scene's own facets. Directions are cosine-weighted. Fewer rays are traced if the result is
 * clear earlier (orl_escape_is_decided). */
void orl_escape_shares(const struct orl_geometry *geometry, uint32_t facet, uint32_t rays,
                       struct orl_random *random, double ret_shares[2]);

/* Returns true if `rays` rays of each side are enough, of which left[] have left. That is so if
 * at least a quarter of one side's leave, and none of the other's. The probability that the
 * other side's share then exceeds a quarter of the first's is at most 1e-7. */
static inline bool orl_escape_is_decided(const uint32_t left[2], uint32_t rays)
{
    const uint32_t more = left[0] > left[1] ? left[0] : left[1];
    return rays >= 256 && more >= rays / 4 && (left[0] == 0 || left[1] == 0);
}

/* Returns true if the side with the larger share is outside and the other one is not. Panes that
 * stand free see open space from both sides, so the result is false. */
bool orl_escape_shows_outside(const double shares[2]);

#endif
