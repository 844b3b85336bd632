/*
 * One photon's life: from its flight out of a port or an emitter, surface by surface, until it is
 * absorbed, leaves, or reaches the bounce limit. Deposits go into the caller's buffer.
 *
 * Global photons are left at every diffuse surface. Caustic photons are left at the first diffuse
 * surface, and only when they come from a directly sampled light (sun, lamp) and were deflected on
 * the way: exactly the light that neither shadow rays nor gathered diffuse radiance account for.
 * In sealed scenes nothing is left outside (light/world.h).
 *
 * Roulette keeps the flux: a photon survives with the luma of its weight.
 */
#ifndef ORL_PHOTON_TRACE_H
#define ORL_PHOTON_TRACE_H

#include "photon/emit.h"
#include "photon/map.h"

enum { ORL_TRACE_MOST_BOUNCES = 1000 };

struct orl_deposits {
    struct orl_photon *photons;
    size_t count, capacity;
    uint64_t rays, escaped, capped;
    bool out_of_memory;
};

void orl_trace_photon(const struct orl_world *world, const struct orl_flight *flight, bool caustic,
                      uint8_t batch, struct orl_random *random, struct orl_deposits *deposits);

#endif
