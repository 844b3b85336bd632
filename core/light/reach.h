/*
 * Whether any light can come to a place at all: asked by paths that leave it, bounce diffusely off
 * whatever they meet, pass windows, look for the open (when there is a sky or a sun), and try at
 * each turn whether a lamp is in sight. What no path finds is dark: a room without a window, the
 * inside of a solid or of a wall. A hole of a millionth of a room's surface is found by 2^14 paths
 * of 64 bounces more likely than not.
 *
 * The answer depends on the seed of the paths alone, not on the crew.
 */
#ifndef ORL_LIGHT_REACH_H
#define ORL_LIGHT_REACH_H

#include "light/world.h"

/* Where light is asked for: on the side of normal, or all round when that is zero. */
struct orl_outlook {
    struct orl_vec3 point, normal;
};

/* True as soon as one of the paths, dealt to the outlooks in turn, has found light; also when the
 * crew is cancelled, for then it is not known. */
bool orl_light_reaches(const struct orl_world *world, const struct orl_outlook *outlooks,
                       size_t count, size_t paths, struct orl_crew *crew);

#endif
