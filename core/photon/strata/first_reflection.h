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
#ifndef ORL_PHOTON_STRATA_FIRST_REFLECTION_H
#define ORL_PHOTON_STRATA_FIRST_REFLECTION_H

#include <oriel/base/thread_pool.h>

#include "photon/emission/emit.h"

/*
 * Sets `reflected` of all strata by pilot emissions; 1 if all light is stored. Returns 0 or
 * ORL_ERR_CANCELLED.
 */
int orl_first_reflection_prepare(struct orl_emission *emission, uint64_t seed,
                                 struct orl_thread_pool *pool);

#endif
