/*
 * Paths from a sensor, shared by all hours: what each adds up is no light, but how much of the
 * light of every bin of the sky, and of every node of the sun, comes to the sensor.
 *
 * A path's parts exclude each other. Sky: where it leaves the scene, its weight goes into the bin
 * of that direction. Sun: at each surface that it comes to, the share of every node that this sends
 * back along it: inside a sealed building by a map of the sunlight on surfaces (sun_map.h; a whole
 * one is asked at the first surface inside alone, as it has what comes of further ones),
 * elsewhere by shadow rays, straight through panes or by one flat mirror. The sun seen from the
 * sensor itself is not here (sunlight.h). At every diffuse surface a path goes on by the cosine and
 * at a port, as the backward technique's do (render/gather/aim.h), but for virtual lamps: all
 * surfaces are met.
 *
 * Light is of the part of the windows by which its path, followed from the sensor, first leaves the
 * building.
 *
 * Samples are named by seed, sensor, batch and number. Immutable but for the sums, which are one
 * batch's own; threads share nothing else.
 */
#ifndef ORL_ANNUAL_TRACE_H
#define ORL_ANNUAL_TRACE_H

#include <oriel/crew.h>

#include "annual/scene.h"
#include "annual/sums.h"

struct orl_annual_batch {
    uint64_t seed, sensor;
    uint32_t batch, first, samples; /* those of samples from first on */
    const struct orl_crew *crew;    /* asked before each sample if the job is cancelled, and then
                                       the rest is left out; NULL: it never is */
};

/* Adds a batch's samples, one after the other. place: the sensor, moved, clear of surfaces; its
 * normal is unit. */
void orl_annual_trace(const struct orl_annual_scene *scene, const struct orl_place *place,
                      const struct orl_annual_batch *batch, struct orl_annual_sums *sums,
                      struct orl_health *health);

/* Adds to the bins a path that sets out from a place outdoors in a direction, with the weight 1;
 * straight: no further than to what it meets but thin panes. */
void orl_annual_trace_out(const struct orl_annual_scene *scene, struct orl_vec3 from,
                          struct orl_vec3 direction, struct orl_random random, bool straight,
                          struct orl_annual_sums *sums, struct orl_health *health);

#endif
