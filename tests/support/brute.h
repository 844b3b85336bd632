/*
 * Plain path tracing, the oracle of `make paths`: from a sensor a direction by the cosine, at each
 * surface one by its material, and light where a path happens to meet it. No shadow rays, no
 * images, no ports, no guiding and no photons, so that no kind of path can be left out; but lights
 * have to be large enough to be met. It shares the scene's geometry and materials with what it
 * judges (those have tests of their own), and nothing that decides where rays go.
 */
#ifndef ORL_TESTS_SUPPORT_BRUTE_H
#define ORL_TESTS_SUPPORT_BRUTE_H

#include <oriel/crew.h>
#include <oriel/run.h>

#include "light/world.h"

struct brute_value {
    double mean, standard_error; /* lx; of a ray cd/m2 */
};

/* Illuminance of n sensors by that many paths each, a multiple of BRUTE_BLOCKS. */
enum { BRUTE_BLOCKS = 64 };
void brute_sensors(const struct orl_world *world, const struct orl_sensor *sensors, size_t n,
                   uint64_t paths, struct orl_crew *crew, struct brute_value *ret_values);

#endif
