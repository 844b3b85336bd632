/*
 * One photon's life: from its flight out of a port or an emitter, surface by surface, until it is
 * absorbed, leaves, or reaches the bounce limit. What is left goes to the caller (deposits.h).
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

#include "photon/flight/deposits.h"
#include "photon/flight/emit.h"

enum { ORL_TRACE_MOST_BOUNCES = 100000, ORL_TRACE_MOST_UNSEEN = 1000 };

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
