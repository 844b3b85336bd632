/*
 * Test whether any light can reach a place at all. Paths leave the place, bounce diffusely off all
 * surfaces and pass windows. They look for the open sky (if there is a sky or a sun), and at each
 * bounce test the visibility of a lamp. A place where no path finds light is dark: a room without a
 * window, the inside of a solid or of a wall. 2^14 paths of 64 bounces find a hole of a millionth
 * of a room's surface with a probability above one half.
 *
 * The result depends only on the seed of the paths, not on the number of threads.
 */
#ifndef ORL_LIGHT_REACH_H
#define ORL_LIGHT_REACH_H

#include "light/world.h"

/* A place where light is searched: on the side of normal, or in all directions if that is zero. */
struct orl_outlook {
    struct orl_vec3 point, normal;
};

/* Returns true as soon as one of the paths has found light; paths are dealt to the outlooks in
 * turn. Also returns true if the crew is cancelled, because the result is then unknown. */
bool orl_light_reaches(const struct orl_world *world, const struct orl_outlook *outlooks,
                       size_t count, size_t paths, struct orl_crew *crew);

#endif
