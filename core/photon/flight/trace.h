/*
 * One photon's life: from its flight out of a port or an emitter, surface by surface, until it is
 * absorbed, leaves, or reaches the bounce limit. Deposits go into the caller's buffer.
 *
 * Global photons are left at every diffuse surface. Caustic photons are left at the first diffuse
 * surface, and only when they come from a directly sampled light (sun, lamp) and were deflected on
 * the way: exactly the light that neither shadow rays nor gathered diffuse radiance account for.
 * In sealed scenes nothing is left outside (light/world.h).
 *
 * Roulette keeps the flux: a photon survives a bounce with the luma of its weight (more surely
 * where nothing was left yet, see first_reflection.h). One number, the flight's fate, decides its
 * whole life: it dies where the product of the chances falls to its fate. As fates come evenly (a
 * Sobol dimension), so do lengths of lives: where walls absorb hardly anything and photons live for
 * 10^4 bounces, a hundred of them light the room to a per cent.
 *
 * Two bounds end what would not end: bounces in all, and bounces in a row that leave no photon
 * (mirrors facing each other). What they cut is counted, with its flux.
 */
#ifndef ORL_PHOTON_FLIGHT_TRACE_H
#define ORL_PHOTON_FLIGHT_TRACE_H

#include <oriel/health.h>

#include "base/sum.h"
#include "photon/flight/discs.h"
#include "photon/flight/emit.h"
#include "photon/map/map.h"

enum { ORL_TRACE_MOST_BOUNCES = 100000, ORL_TRACE_MOST_UNSEEN = 1000 };

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

/* The counts, fluxes included. */
struct orl_health orl_deposits_health(const struct orl_deposits *deposits);

void orl_trace_photon(const struct orl_world *world, const struct orl_flight *flight, bool caustic,
                      uint8_t batch, struct orl_random *random, struct orl_deposits *deposits);

/*
 * Many, at most ORL_EMISSIONS_AT_ONCE, of those flights that fly; each photon's batch is its number
 * modulo ORL_MAP_BATCHES. They take each step together, so that rays go side by side and draws wait
 * for memory together, and leave what they would have left one after the other, in that order.
 */
void orl_trace_many(const struct orl_world *world, const struct orl_flight *flights,
                    const bool *flies, size_t n, bool caustic, struct orl_random *randoms,
                    struct orl_deposits *deposits);

#endif
