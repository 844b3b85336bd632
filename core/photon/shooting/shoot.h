/*
 * Photon tracing up to a target number, for global and caustic photons in one pass, on all cores.
 *
 * Work is divided into batches of emissions, identified by index. The first batches are small,
 * because an emission may leave 10^4 photons where walls absorb little; later ones have a fixed
 * size. Rounds of batches are sized from the counts of earlier rounds, never from time or threads.
 * A map takes all batches up to the first that reaches its target. So its photons, their order and
 * the number emitted depend only on the seed. A larger target continues where a smaller one
 * stopped: a map's numbers of photons and emissions determine the remaining batches.
 */
#ifndef ORL_PHOTON_SHOOTING_SHOOT_H
#define ORL_PHOTON_SHOOTING_SHOOT_H

#include <stdatomic.h>

#include <oriel/base/health.h>

#include "photon/map/map.h"
#include "photon/tracing/trace.h"

enum orl_map_kind {
    ORL_MAP_GLOBAL,
    ORL_MAP_CAUSTIC,
    ORL_SHOT_KINDS, /* number of kinds that are traced */
    /* irradiance computed from the global map (precomputed_irradiance.h) */
    ORL_MAP_PRECOMPUTED = ORL_SHOT_KINDS,
    ORL_MAP_KINDS
};
/* returns "global", "caustic", "precomputed" */
const char *orl_map_kind_name(enum orl_map_kind kind);

struct orl_shot {
    uint64_t target; /* in: total number of photons wanted; 0 for none */
    /* in: photons and emissions of an earlier, smaller shot that found some; 0: none */
    uint64_t earlier_count, earlier_emitted;
    /* out: the new photons, in order of emission, owned by the caller; or NULL */
    struct orl_photon *photons;
    size_t count;     /* out: number of new photons */
    uint64_t emitted; /* out: emissions, with those of the earlier shot */
    /* counters of this shot; fluxes are divided by its emissions: watts */
    struct orl_health health;
};

struct orl_shoot_env {
    const struct orl_emission *emission;
    uint64_t seed;
    struct orl_thread_pool *pool;
    atomic_bool *cancel;
    bool unsampled_only; /* only for pilots (photon_pilot.h): as in orl_deposits */
    void (*progress)(void *ctx, double fraction);
    void *ctx;
};

/*
 * Emits and traces photons of a kind from index `first` on, which is a multiple of ORL_MAP_BATCHES:
 * n emissions, but at most ORL_EMISSIONS_AT_ONCE. Returns their number. Used by shots, and by
 * callers that count photons otherwise.
 */
size_t orl_shoot_chunk(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                       uint64_t n, struct orl_deposits *deposits);

/*
 * Fills shots[kind]. Returns 0, ORL_ERR_CANCELLED, ORL_ERR_NOMEM, or ORL_ERR_CORRUPT if no shot
 * stops at had_emitted; on failure photons are freed.
 */
int orl_shoot(const struct orl_shoot_env *env, struct orl_shot shots[ORL_SHOT_KINDS],
              struct orl_error *err);

struct orl_deposits;
size_t orl_shoot_chunk(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                       uint64_t n, struct orl_deposits *deposits);

#endif
