/*
 * Pilots that set the shares of strata. One for light whose first hit is not stored, in strata.c,
 * which builds an emission (emit.h); one for caustics, in caustic_pilot.c.
 */
#ifndef ORL_PHOTON_STRATA_STRATA_H
#define ORL_PHOTON_STRATA_STRATA_H

#include <oriel/base/thread_pool.h>

#include "photon/emission/emit.h"

/*
 * Estimates the caustic flux of each stratum by a pilot. Sets share_caustic and place of an
 * emission's strata, which must be listed, and has_caustics. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED.
 */
int orl_caustic_pilot(struct orl_emission *emission, uint64_t seed, struct orl_thread_pool *pool);

#endif
