/*
 * Sums over the paths of one batch of a sensor (trace_sensor.h): luma, by the part of the windows
 * through which the light comes in (annual_scene.h).
 */
#ifndef ORL_ANNUAL_ROWS_SUMS_H
#define ORL_ANNUAL_ROWS_SUMS_H

#include <string.h>

#include <oriel/vec.h>

#include "annual/sky/bins.h"
#include "bsdf/basis.h"

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
struct orl_annual_sums {
    /* By part: 1 if its bins and nodes are set; those of other parts are undefined. NULL: there
     * is one part, which is set. */
    unsigned char *lit;
    float *bins;   /* [part][ORL_BINS]: irradiance for a radiance of 1 in the bin */
    double *nodes; /* [part][n_nodes]: irradiance for a sun with a normal irradiance of 1 */
    size_t n_nodes;
    double *beams; /* by beam of the map: irradiance, of light through its ports alone */
    float *lots;   /* [beam][ORL_SUN_MAP_LOTS]: irradiance estimated by each lot of photons */
    struct orl_annual_exits *exits; /* NULL: paths pass through windows */
};

/* Sets the sums of a part to 0 at its first use. */
static inline void orl_annual_sums_need(const struct orl_annual_sums *sums, uint32_t part)
{
    if (!sums->lit || sums->lit[part])
        return;
    sums->lit[part] = 1;
    memset(sums->bins + (size_t)part * ORL_BINS, 0, ORL_BINS * sizeof *sums->bins);
    memset(sums->nodes + part * sums->n_nodes, 0, sums->n_nodes * sizeof *sums->nodes);
}

static inline void orl_annual_add_to_bin(const struct orl_annual_sums *sums, uint32_t part,
                                         uint32_t bin, double light)
{
    orl_annual_sums_need(sums, part);
    sums->bins[(size_t)part * ORL_BINS + bin] += (float)light;
}

static inline void orl_annual_add_to_node(const struct orl_annual_sums *sums, uint32_t part,
                                          size_t node, double light)
{
    orl_annual_sums_need(sums, part);
    sums->nodes[part * sums->n_nodes + node] += light;
}

#endif
