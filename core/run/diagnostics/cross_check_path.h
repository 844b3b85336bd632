/*
 * Plain path tracing from a sensor, for the cross-check (cross_check.c), without photons, ports,
 * importance-sampled rays or caches. The light that a path finds is summed by class, which says how
 * it reached the sensor.
 */
#ifndef ORL_RUN_DIAGNOSTICS_CROSS_CHECK_PATH_H
#define ORL_RUN_DIAGNOSTICS_CROSS_CHECK_PATH_H

#include <oriel/base/input_checks.h>
#include <oriel/job/run.h>

#include "light/lit_scene.h"
#include "render/gather/gather.h"

/* One estimate of the irradiance at a place, lx, by class. */
struct orl_plain_light {
    double lx[ORL_LIGHT_CLASSES];
};

/* Traces one path, with shadow rays at every surface and at most most_reflections diffuse
 * reflections, and returns its estimate. */
struct orl_plain_light orl_plain_path(const struct orl_lit_scene *lit_scene,
                                      const struct orl_shading_point *place,
                                      uint32_t most_reflections, struct orl_random *random,
                                      struct orl_health *health);

#endif
