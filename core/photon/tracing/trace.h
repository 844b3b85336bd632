/*
 * Tracing of a photon from its port or emitter, from surface to surface, until it is absorbed,
 * leaves, or reaches the bounce limit. Deposits go to the caller (deposits.h).
 *
 * Global photons are deposited on every diffuse surface. Caustic photons are deposited on the first
 * diffuse surface, and only if they come from a directly sampled light (sun, lamp) and were
 * deflected on the way. That is exactly the light for which neither shadow rays nor gathered
 * diffuse radiance account. In sealed scenes no photon is deposited outside (light/lit_scene.h).
 *
 * Russian roulette keeps the flux: a photon survives a bounce with the luma of its weight (with a
 * higher probability before its first deposit, see first_reflection.h). One number, the photon's
 * roulette number, decides for its whole life: the photon dies when the product of the survival
 * probabilities falls to its roulette number. Roulette numbers are stratified (a Sobol dimension),
 * and so are the lengths of lives. Where walls absorb hardly anything and photons live for 10^4
 * bounces, a hundred photons light the room to within a per cent.
 *
 * Two limits end endless paths: the number of bounces, and the number of consecutive bounces
 * without a deposit (facing mirrors). Photons that are cut are counted, with their flux.
 */
#ifndef ORL_PHOTON_TRACING_TRACE_H
#define ORL_PHOTON_TRACING_TRACE_H

#include "photon/emission/emit.h"
#include "photon/tracing/deposits.h"

enum { ORL_TRACE_MOST_BOUNCES = 100000, ORL_TRACE_MOST_UNSTORED = 1000 };

void orl_trace_photon(const struct orl_lit_scene *lit_scene,
                      const struct orl_photon_ray *photon_ray, bool caustic, uint8_t batch,
                      struct orl_random *random, struct orl_deposits *deposits);

/*
 * Traces the photons that were emitted, at most ORL_EMISSIONS_AT_ONCE. Each photon's batch is its
 * index modulo ORL_MAP_BATCHES. They take each step together, so that rays and samples are
 * processed side by side. Deposits and their order are the same as if the photons were traced one
 * by one.
 */
void orl_trace_many(const struct orl_lit_scene *lit_scene, const struct orl_photon_ray *photon_rays,
                    const bool *is_emitted, size_t n, bool caustic, struct orl_random *randoms,
                    struct orl_deposits *deposits);

#endif
