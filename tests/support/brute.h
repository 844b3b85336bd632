/*
 * Plain path tracing, the oracle of `make paths`: a direction by the cosine at the sensor, at each
 * surface one by its material, and light only where a path happens to hit it. It has no shadow
 * rays, images, ports, guiding or photons, so it omits no kind of path; but lights must be large
 * enough to be hit. It shares the scene's geometry and materials with the code under test (these
 * have their own tests), and nothing that selects directions.
 */
#ifndef ORL_TESTS_SUPPORT_BRUTE_H
#define ORL_TESTS_SUPPORT_BRUTE_H

#include <oriel/base/thread_pool.h>
#include <oriel/job/run.h>

#include "light/lit_scene.h"

struct brute_value {
    double mean, standard_error; /* lx; cd/m2 for a ray */
};

/* Computes the illuminance of n sensors with `paths` paths each, a multiple of BRUTE_BLOCKS. */
enum { BRUTE_BLOCKS = 64 };
void brute_sensors(const struct orl_lit_scene *lit_scene, const struct orl_sensor *sensors,
                   size_t n, uint64_t paths, struct orl_thread_pool *pool,
                   struct brute_value *ret_values);

#endif
