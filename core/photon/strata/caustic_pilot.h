/* Pilot that estimates the caustic flux of each stratum, and so its share of caustic photons. */
#ifndef ORL_PHOTON_STRATA_CAUSTIC_PILOT_H
#define ORL_PHOTON_STRATA_CAUSTIC_PILOT_H

#include <oriel/base/thread_pool.h>

#include "photon/emission/emit.h"

/* Sets share_caustic and place of an emission's strata, which must be listed, and has_caustics.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_caustic_pilot(struct orl_emission *emission, uint64_t seed, struct orl_thread_pool *pool);

#endif
