/*
 * Importance of points on a window for caustics: where a sun's light continues to a mirror, a lens
 * or a lobe. A mirror of a square centimetre behind a window of three square metres gets one photon
 * in 30 000. That is too few for a caustic, and a pilot easily finds none. So the search is
 * reversed: rays from points on every such facet are traced towards the sun, and the points where
 * they pass a window are recorded. If only a small part of the window leads to targets, nine in ten
 * caustic photons start there.
 *
 * Ownership: the table belongs to the stratum, and is freed with the emission.
 */
#ifndef ORL_PHOTON_STRATA_CAUSTIC_TARGETS_H
#define ORL_PHOTON_STRATA_CAUSTIC_TARGETS_H

#include "photon/emission/emit.h"

enum {
    ORL_CAUSTIC_TARGET_SIDE = 64,
    ORL_CAUSTIC_TARGET_CELLS = ORL_CAUSTIC_TARGET_SIDE * ORL_CAUSTIC_TARGET_SIDE
};

/* Returns the cell of the two numbers that sample a point on a facet. */
static inline size_t orl_caustic_target_cell(const double u[2])
{
    const size_t x = (size_t)(u[0] * ORL_CAUSTIC_TARGET_SIDE),
                 y = (size_t)(u[1] * ORL_CAUSTIC_TARGET_SIDE);
    const size_t last = ORL_CAUSTIC_TARGET_SIDE - 1;
    return (y < last ? y : last) * ORL_CAUSTIC_TARGET_SIDE + (x < last ? x : last);
}

/*
 * Adds to found[stratum], for suns in ports, the flux through each cell that reaches such facets,
 * in watts of luma. Allocates entries that are NULL if they get any flux. crew: polled for
 * cancellation. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_caustic_target_find(const struct orl_emission *emission, const struct orl_thread_pool *pool,
                            double **target_flux);

/* Makes a stratum's table from that flux; leaves it empty if most of the pane leads to targets.
 * Returns 0 or ORL_ERR_NOMEM. */
int orl_caustic_target_build(struct orl_stratum *stratum, const double *target_flux);

#endif
