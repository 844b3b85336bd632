/*
 * Results of traced photons: deposits on surfaces, or crossings through discs, and counts of
 * failures.
 *
 * Fluxes are in W by channel, before the division by the number of emissions (photon/map/map.h).
 * Ownership: photons and crossings are the caller's. Threads: each has its own.
 */
#ifndef ORL_PHOTON_TRACING_DEPOSITS_H
#define ORL_PHOTON_TRACING_DEPOSITS_H

#include <oriel/base/health.h>

#include "base/statistics/sum.h"
#include "photon/map/map.h"
#include "photon/tracing/counting_discs.h"

struct orl_deposits {
    struct orl_photon *photons;
    size_t count, capacity;
    bool out_of_memory;
    struct orl_health health;         /* without the fluxes, which are the sums below */
    struct orl_sum flux, flux_capped; /* luma of photons traced, and of photons given up */
    /* Caustic photons in orl_trace_many: discs in which they are counted, instead of being
     * deposited on surfaces; NULL: none. Suns by images in flat mirrors, or by the lobes of one
     * pane, are not counted, because sensors sample them otherwise. */
    const struct orl_counting_discs *discs;
    struct orl_disc_crossings crossings;
    /* Caustic photons: true keeps only those that backward paths (render/backward/backward.h)
     * find by chance. Those that backward paths sample are neither deposited nor counted. */
    bool unsampled_only;
};

/* Reserves memory for more photons. Returns false and sets out_of_memory if there is none. */
bool orl_deposits_reserve(struct orl_deposits *deposits, size_t more);

/* Deposits a photon. One that is not finite, also as floats, is dropped and counted. */
void orl_deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                 uint8_t batch, enum orl_photon_class class);

/* Counts a photon that is cut at a bounce limit, with its flux. */
void orl_deposits_count_capped(struct orl_deposits *deposits, struct orl_rgb flux);

/* Returns the counts, with the fluxes. */
struct orl_health orl_deposits_health(const struct orl_deposits *deposits);

#endif
