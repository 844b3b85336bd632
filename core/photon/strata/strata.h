/*
 * Emission of light whose first hit is not stored in the map. Shadow rays and caustic photons
 * count the direct light of suns and lamps, and maps that are viewed directly begin with its first
 * reflection (omit.counted_light). If all of it were emitted as photons of equal flux, most would
 * end on that first surface without leaving a photon.
 *
 * So such strata emit fewer photons with more flux each. The factor is the mean albedo of the
 * surfaces that they land on first, weighted by the reflected light. At the first reflection a
 * photon survives with a probability of its albedo over that mean, and its flux is multiplied by
 * the mean. So the photons that it deposits have the same flux as others. On brighter surfaces it
 * always survives, and has more flux. Any value is unbiased; a good one is efficient.
 */
#ifndef ORL_PHOTON_STRATA_STRATA_H
#define ORL_PHOTON_STRATA_STRATA_H

#include <oriel/base/thread_pool.h>

#include "photon/emission/emit.h"

/*
 * Sets `reflected` of all strata by pilot emissions; 1 if all light is stored. Returns 0 or
 * ORL_ERR_CANCELLED.
 */
int orl_first_reflection_prepare(struct orl_emission *emission, uint64_t seed,
                                 struct orl_thread_pool *pool);

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

/* Pilot that estimates the caustic flux of each stratum, and so its share of caustic photons. */

/* Sets share_caustic and place of an emission's strata, which must be listed, and has_caustics.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_caustic_pilot(struct orl_emission *emission, uint64_t seed, struct orl_thread_pool *pool);

#endif
