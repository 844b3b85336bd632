/*
 * Where on a window a sun's light goes on to a mirror, a lens or a lobe. A mirror of a square
 * centimetre behind a window of three square metres gets one photon in 30 000: too few to make a
 * caustic of, and easily none of a pilot's. So it is asked the other way about: from points on
 * every such facet rays go towards the sun, and where they pass a window is noted. Where little of
 * the window leads to any, caustic photons start there, nine in ten of them.
 *
 * Ownership: the table goes into the stratum, and with the emission.
 */
#ifndef ORL_PHOTON_FLIGHT_CAUSTIC_TARGETS_H
#define ORL_PHOTON_FLIGHT_CAUSTIC_TARGETS_H

#include "photon/flight/emit.h"

enum {
    ORL_CAUSTIC_TARGET_SIDE = 64,
    ORL_CAUSTIC_TARGET_CELLS = ORL_CAUSTIC_TARGET_SIDE * ORL_CAUSTIC_TARGET_SIDE
};

/* The cell of two numbers that a place on a facet is drawn by. */
static inline size_t orl_caustic_target_cell(const double u[2])
{
    const size_t x = (size_t)(u[0] * ORL_CAUSTIC_TARGET_SIDE),
                 y = (size_t)(u[1] * ORL_CAUSTIC_TARGET_SIDE);
    const size_t last = ORL_CAUSTIC_TARGET_SIDE - 1;
    return (y < last ? y : last) * ORL_CAUSTIC_TARGET_SIDE + (x < last ? x : last);
}

/*
 * Adds to found[stratum], for suns in ports, what reaches such facets by each cell, in watts of
 * luma; allocates what is NULL and has something to hold. crew: whose cancellation is heeded.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_caustic_target_look(const struct orl_emission *emission, const struct orl_crew *crew,
                            double **found);

/* A stratum's table from what was found there; leaves it empty where most of the pane leads on. */
int orl_caustic_target_settle(struct orl_stratum *stratum, const double *found);

#endif
