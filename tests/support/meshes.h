/*
 * Closed meshes, and rays that search for leaks.
 */
#ifndef ORL_TESTS_SUPPORT_MESHES_H
#define ORL_TESTS_SUPPORT_MESHES_H

#include <stdint.h>

#include "base/sampling/sampling.h"
#include "scene/geometry/geometry.h"

#define MESH_GREY "void plastic m 0 0 5 .5 .5 .5 0 0\n"
#define MESH_BOX MESH_GREY "!genbox m b 3 2 1.5\n"

/*
 * Returns an icosphere as scene text: 20 faces split into 4^2 each, normals outwards, vertices
 * shared to the digit. free() it.
 */
char *mesh_icosphere(void);

/* Returns a unit vector, uniform over the sphere. */
struct orl_vec3 mesh_direction(struct orl_random *random);

/* Counts the rays that leave the mesh, among rays from inside, aimed at edges, at corners and
 * anywhere. */
uint64_t mesh_leaks(const struct orl_geometry *geometry, uint64_t rays, uint64_t seed);

/* Counts the rays that leave along a bouncing path, which starts anew at every hit. */
uint64_t mesh_leaks_on_bounce(const struct orl_geometry *geometry, uint64_t bounces, uint64_t seed);

#endif
