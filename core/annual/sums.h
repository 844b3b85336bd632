/*
 * What the paths of one batch of a sensor come to (trace.h): luma, summed up over its samples, by
 * the part of the windows that light comes in by (scene.h).
 */
#ifndef ORL_ANNUAL_SUMS_H
#define ORL_ANNUAL_SUMS_H

#include <string.h>

#include <oriel/vec.h>

#include "annual/bins.h"
#include "bsdf/basis.h"

/* Where paths end that look at windows from inside, in place of going on through them: by which
 * window, and in which cell of directions about the way it faces inwards. */
struct orl_annual_exits {
    const uint32_t *window_of_port;
    const struct orl_frame *frames; /* by window: n inwards */
    const struct orl_basis *basis;
    float *all, *straight; /* [window][cell]: irradiance, of radiance 1; and without reflections */
};

/* Without nodes the sun is not looked for. */
struct orl_annual_sums {
    unsigned char *lit; /* by part: it has bins and nodes; those of others are not set. NULL: there
                           is one part, which has them */
    float *bins;        /* [part][ORL_BINS]: irradiance, of radiance 1 there */
    double *nodes;      /* [part][n_nodes]: irradiance, of a sun that gives 1 to what faces it */
    size_t n_nodes;
    double *beams; /* by beam of the map: the same, of what comes through its ports alone */
    float *lots;   /* [beam][ORL_SUN_MAP_LOTS]: the same, as each lot of photons has it */
    struct orl_annual_exits *exits; /* NULL: windows are gone through */
};

/* Sets a part that has no sums yet to 0. */
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
