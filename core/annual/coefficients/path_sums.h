/*
 * Sums over the paths of one batch of a sensor (trace_sensor.h): luma, by the window group
 * through which the light comes in (annual_scene.h).
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_PATH_SUMS_H
#define ORL_ANNUAL_COEFFICIENTS_PATH_SUMS_H

#include <string.h>

#include <oriel/base/vec.h>

#include "annual/sky/bins.h"
#include "bsdf/matrix/basis.h"

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

/* Without nodes sunlight is not computed. */
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

#endif
