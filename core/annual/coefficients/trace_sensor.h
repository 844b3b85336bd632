/* Paths from a sensor, shared by all hours, and the sums that they fill. */
#ifndef ORL_ANNUAL_COEFFICIENTS_TRACE_SENSOR_H
#define ORL_ANNUAL_COEFFICIENTS_TRACE_SENSOR_H

#include <string.h>

#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>

#include "annual/sky/bins.h"
#include "annual/year/annual_scene.h"
#include "bsdf/matrix/matrix.h"

/* Accumulators for paths that end at the inner side of windows, instead of passing them: by window,
 * and by cell of directions about the window's inward axis. */
struct orl_annual_exits {
    const uint32_t *window_of_port;
    const struct orl_frame *frames; /* by window: n points inwards */
    const struct orl_basis *basis;
    /* [window][cell]: irradiance for a radiance of 1, of all paths, and of paths without
     * reflections. */
    float *all, *straight;
};

/* Sums over the paths of one batch of a sensor: luma, by the window group through which the light
 * comes in (annual_scene.h). Without nodes sunlight is not computed. */
struct orl_path_sums {
    /* By window group: 1 if its bins and nodes are set; those of other window groups are undefined.
     * NULL: there is one window group, which is set. */
    unsigned char *lit;
    float *bins;   /* [window group][ORL_BINS]: irradiance for a radiance of 1 in the bin */
    double *nodes; /* [window group][n_nodes]: irradiance for a sun with a normal irradiance of 1 */
    size_t n_nodes;
    double *beams;         /* by beam of the map: irradiance, of light through its ports alone */
    float *photon_batches; /* [beam][ORL_SUN_PHOTON_BATCHES]: irradiance estimated by each photon
                              batch */
    struct orl_annual_exits *exits; /* NULL: paths pass through windows */
};

/* Sets the sums of a window group to 0 at its first use. */
static inline void orl_path_sums_ensure(const struct orl_path_sums *sums, uint32_t window_group)
{
    if (!sums->lit || sums->lit[window_group])
        return;
    sums->lit[window_group] = 1;
    memset(sums->bins + (size_t)window_group * ORL_BINS, 0, ORL_BINS * sizeof *sums->bins);
    memset(sums->nodes + window_group * sums->n_nodes, 0, sums->n_nodes * sizeof *sums->nodes);
}

static inline void orl_path_sums_add_bin(const struct orl_path_sums *sums, uint32_t window_group,
                                         uint32_t bin, double light)
{
    orl_path_sums_ensure(sums, window_group);
    sums->bins[(size_t)window_group * ORL_BINS + bin] += (float)light;
}

static inline void orl_path_sums_add_node(const struct orl_path_sums *sums, uint32_t window_group,
                                          size_t node, double light)
{
    orl_path_sums_ensure(sums, window_group);
    sums->nodes[window_group * sums->n_nodes + node] += light;
}

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
 * technique (render/gather/direction_sampling.h), but without virtual lights.
 *
 * Samples are keyed by seed, sensor, batch and number. Immutable but for the sums, which belong to
 * one batch; threads share nothing else.
 */

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
