/*
 * What flights leave: photons at surfaces, or passes through discs, and counts of what went wrong.
 *
 * Fluxes are in W by channel, before the division by the number of flights (photon/map/map.h).
 * Ownership: photons and passes are the caller's. Threads: each has its own.
 */
#ifndef ORL_PHOTON_FLIGHT_DEPOSITS_H
#define ORL_PHOTON_FLIGHT_DEPOSITS_H

#include <oriel/health.h>

#include "base/sum.h"
#include "photon/flight/discs.h"
#include "photon/map/map.h"

struct orl_deposits {
    struct orl_photon *photons;
    size_t count, capacity;
    bool out_of_memory;
    struct orl_health health;         /* but for the fluxes: */
    struct orl_sum flux, flux_capped; /* luma, of photons traced and given up */
    /* Of caustic flights in many: discs that they are counted through, instead of being left at
     * surfaces; NULL: none. Passes of light that is found otherwise are not noted: of suns by
     * images in flat mirrors or by the lobes of one pane. */
    const struct orl_discs *discs;
    struct orl_passes passes;
    /* Of caustic flights: what paths against the light find on purpose (render/backward/backward.h)
     * is neither noted nor left, only what they would have to happen on. */
    bool by_chance;
};

/* Room for more photons. False: there is no memory, which is noted. */
bool orl_deposits_reserve(struct orl_deposits *deposits, size_t more);

/* Leaves a photon; one that is no finite number, also as floats, is dropped and counted. */
void orl_deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                 uint8_t batch, enum orl_photon_class class);

/* Counts a photon that is followed no further, with its flux. */
void orl_deposits_give_up(struct orl_deposits *deposits, struct orl_rgb flux);

/* The counts, fluxes included. */
struct orl_health orl_deposits_health(const struct orl_deposits *deposits);

#endif
