/*
 * Tracing of photons, and its results: deposits on surfaces, or crossings through discs in free
 * space.
 *
 * Discs in which photons are counted surround sensors in free space, where no photon lands. Photons
 * carry flux. So the flux through a disc on its lit side, divided by the disc's area, is
 * the irradiance there, whatever the photons' paths.
 *
 * A disc ends where an object stands on its plane. Its reach is stored by sectors; crossings beyond
 * the reach are not counted, nor is that area. Photons whose light another estimator counts are not
 * counted here (is_unsampled in trace.c): suns by their images in flat mirrors, or by one pane's
 * lobes.
 *
 * The hierarchy is immutable once made, and any thread may query it. It borrows the discs.
 */
#ifndef ORL_PHOTON_TRACING_TRACE_H
#define ORL_PHOTON_TRACING_TRACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/input_checks.h>

#include "base/statistics/numeric.h"
#include "photon/emission/emit.h"
#include "photon/map/map.h"
#include "scene/material/scatter.h"

enum { ORL_COUNTING_DISC_SECTORS = 32 };

struct orl_counting_disc {
    struct orl_vec3 center;
    struct orl_frame frame; /* n: towards the lit side */
    double radius;
    float
        /* distance of the nearest dielectric or curved mirror on its plane; INFINITY: none */
        curved_distance;
    /* squared reach by sectors, counted from frame.u; at most radius^2 */
    float reach2[ORL_COUNTING_DISC_SECTORS];
};

/* The crossing of a photon through a disc. */
struct orl_disc_crossing {
    uint32_t disc;
    float distance2; /* squared distance from the disc's center */
    float flux[3];
    uint8_t batch;
    bool lamp; /* light of a lamp, not of a sun */
};

struct orl_disc_crossings {
    struct orl_disc_crossing *crossings; /* owned by the caller, who frees it */
    size_t count, capacity;
    bool out_of_memory;
};

struct orl_counting_discs;

/* Builds the hierarchy. Returns 0 or ORL_ERR_NOMEM. */
int orl_counting_discs_new(const struct orl_counting_disc *discs, size_t count,
                           struct orl_counting_discs **ret_discs);
void orl_counting_discs_free(struct orl_counting_discs *discs); /* NULL is allowed */

/* A straight part of a photon's path, to its next hit. */
struct orl_ray_segment {
    struct orl_vec3 origin, direction;
    double distance;     /* to the hit; INFINITY: none */
    struct orl_rgb flux; /* at its origin */
    /* the spotlight's beam at the origin (orl_spotlight_falloff); focus 0: no such beam */
    double focus, lamp_distance, spread;
    bool lamp;
    uint8_t batch;
};

/* Records a crossing for every disc that the segment crosses. */
void orl_counting_discs_record(const struct orl_counting_discs *discs,
                               const struct orl_ray_segment *ray_segment,
                               struct orl_disc_crossings *crossings);

/*
 * Results of traced photons: deposits on surfaces, or crossings through discs, and counts of
 * failures.
 *
 * Fluxes are in W by channel, before the division by the number of emissions (photon/map/map.h).
 * Ownership: photons and crossings are the caller's. Threads: each has its own.
 */

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
    /* Caustic photons: true selects only those that backward paths (render/backward/backward.h)
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

/*
 * Tracing of a photon from its port or emitter, from surface to surface, until it is absorbed,
 * leaves, or reaches the bounce limit. Deposits go to the caller (struct orl_deposits).
 *
 * Global photons are deposited on every diffuse surface. Caustic photons are deposited on the first
 * diffuse surface, and only if they come from a directly sampled light (sun, lamp) and were
 * deflected on the way. That is exactly the light for which neither shadow rays nor gathered
 * diffuse radiance account. In sealed scenes no photon is deposited outside (light/lit_scene.h).
 *
 * Russian roulette conserves the mean flux: a photon survives a bounce with the luma of its weight
 * (with a higher probability before its first deposit, see strata/strata.c). One number, the
 * photon's roulette number, decides for its whole life: the photon dies when the product of the
 * survival probabilities falls to its roulette number. Roulette numbers are stratified (a Sobol
 * dimension), and so are the lengths of lives. Where walls absorb hardly anything and photons live
 * for 10^4 bounces, a hundred photons light the room to within a per cent.
 *
 * Two limits end endless paths: the number of bounces, and the number of consecutive bounces
 * without a deposit (facing mirrors). Photons that are cut are counted, with their flux.
 */

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
