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

/* Returns the number of samples that each of n things gets of a total, within bounds. */
static inline uint32_t orl_pilot_share(size_t total, size_t n, uint32_t least, uint32_t most)
{
    const size_t each = total / n;
    return each > most ? most : each < least ? least : (uint32_t)each;
}

#endif
