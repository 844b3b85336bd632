/*
 * One plain path from a sensor, for the cross-check (cross_check.c): no photons, no ports, no rays
 * that are aimed, no caches. Its light is told apart by how it came to the sensor.
 */
#ifndef ORL_RUN_CROSS_CHECK_PATH_H
#define ORL_RUN_CROSS_CHECK_PATH_H

#include <oriel/health.h>
#include <oriel/run.h>

#include "light/world.h"
#include "render/gather/gather.h"

/* One estimate of the irradiance at a place, lx, by class. */
struct orl_plain_light {
    double lx[ORL_LIGHT_CLASSES];
};

/* Draws it by one path with shadow rays at every surface; diffuse reflections are followed up to
 * that number. */
struct orl_plain_light orl_plain_path(const struct orl_world *world, const struct orl_place *place,
                                      uint32_t most_reflections, struct orl_random *random,
                                      struct orl_health *health);

#endif
