/*
 * Paths from a sensor, shared by all hours. They accumulate coefficients instead of light: how much
 * of the radiance of each sky bin, and of each node of the sun, reaches the sensor.
 *
 * The contributions of a path exclude each other. Sky: where a path leaves the scene, its weight is
 * added to the bin of that direction. Sun: each surface on the path adds the light of every node
 * that it reflects or transmits along the path. Inside a sealed building this light comes from a
 * map of sunlight on surfaces (sun_map.h). A whole map is read only at the first surface inside,
 * because it includes later bounces. Elsewhere shadow rays find the light, straight, through panes
 * or by one flat mirror. Sunlight directly at the sensor is computed separately (sunlight.h). At
 * diffuse surfaces paths continue by cosine sampling and port sampling, as in the backward
 * technique (render/gather/direction_sampling.h), but without virtual lamps.
 *
 * Light belongs to the window group by which its path, followed from the sensor, first
 * leaves the building.
 *
 * Samples are keyed by seed, sensor, batch and number. Immutable but for the sums, which belong to
 * one batch; threads share nothing else.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_TRACE_SENSOR_H
#define ORL_ANNUAL_COEFFICIENTS_TRACE_SENSOR_H

#include <oriel/base/thread_pool.h>

#include "annual/coefficients/path_sums.h"
#include "annual/year/annual_scene.h"

struct orl_annual_batch {
    uint64_t seed, sensor;
    uint32_t batch, first, samples; /* samples of the batch, and the first one to trace */
    /* Checked for cancellation before each sample, and the rest is then left out; may be NULL. */
    const struct orl_thread_pool *pool;
};

/* Traces samples of a batch in order and adds them to sums. place: the sensor, moved clear of
 * surfaces; its normal is unit. */
void orl_annual_trace(const struct orl_annual_scene *scene, const struct orl_shading_point *place,
                      const struct orl_annual_batch *batch, struct orl_path_sums *sums,
                      struct orl_health *health);

/* Traces a path of weight 1 from a place outdoors in a direction, and adds it to the bins.
 * straight: the path ends at the first surface other than thin panes. */
void orl_annual_trace_outdoors(const struct orl_annual_scene *scene, struct orl_vec3 from,
                               struct orl_vec3 direction, struct orl_random random, bool straight,
                               struct orl_path_sums *sums, struct orl_health *health);

#endif
