/*
 * Test whether any light can reach a place at all. Paths leave the place, bounce diffusely off all
 * surfaces and pass windows. They look for the open sky (if there is a sky or a sun), and at each
 * bounce test the visibility of a lamp. A place where no path finds light is dark: a room without a
 * window, the inside of a solid or of a wall. 2^14 paths of 64 bounces find a hole of a millionth
 * of a room's surface with a probability above one half.
 *
 * The result depends only on the seed of the paths, not on the number of threads.
 */
#ifndef ORL_LIGHT_REACHABILITY_H
#define ORL_LIGHT_REACHABILITY_H

#include "light/lit_scene.h"

/* A place where light is searched: on the side of normal, or in all directions if that is zero. */
struct orl_query_point {
    struct orl_vec3 point, normal;
};

/* Returns true as soon as one of the paths has found light; paths are dealt to the outlooks in
 * turn. Also returns true if the crew is cancelled, because the result is then unknown. */
bool orl_light_reaches(const struct orl_lit_scene *lit_scene,
                       const struct orl_query_point *query_points, size_t count, size_t paths,
                       struct orl_thread_pool *pool);

#endif
