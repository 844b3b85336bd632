/*
 * Tracing photons until there are enough: global and caustic ones in one pass, by all cores.
 *
 * Work goes in batches of emissions, named by index: small ones first, for an emission may leave
 * 10^4 photons where walls absorb little, then of a fixed size. Rounds of batches are sized from
 * the counts of the rounds before, never from time or threads. A map takes all batches up to the
 * first that reaches its target, so that its photons, their order and the number emitted depend on
 * the seed alone, and a larger target continues where a smaller one stopped: from a map's numbers
 * of photons and emissions follows which batches are left.
 */
#ifndef ORL_PHOTON_SHOOTING_SHOOT_H
#define ORL_PHOTON_SHOOTING_SHOOT_H

#include <stdatomic.h>

#include <oriel/health.h>

#include "photon/flight/trace.h"
#include "photon/map/map.h"

enum orl_map_kind {
    ORL_MAP_GLOBAL,
    ORL_MAP_CAUSTIC,
    ORL_SHOT_KINDS,                       /* those of photons that are shot */
    ORL_MAP_PRECOMPUTED = ORL_SHOT_KINDS, /* irradiance made from the global map (records.h) */
    ORL_MAP_KINDS
};
const char *orl_map_kind_name(enum orl_map_kind kind); /* "global", "caustic", "precomputed" */

struct orl_shot {
    uint64_t target;            /* in: photons wanted, in all; 0 for none */
    uint64_t had, had_emitted;  /* in: of an earlier, smaller shot that found some; 0: none */
    struct orl_photon *photons; /* out, the caller's: the others, in order of emission; or NULL */
    size_t count;               /* of these */
    uint64_t emitted;           /* in all */
    struct orl_health health;   /* of this shot; fluxes divided by what it emitted: watts */
};

struct orl_shoot_env {
    const struct orl_emission *emission;
    uint64_t seed;
    struct orl_crew *crew;
    atomic_bool *cancel;
    bool by_chance; /* of a pilot alone (worth.h): see orl_deposits */
    void (*progress)(void *ctx, double fraction);
    void *ctx;
};

/*
 * The emissions of that kind from the first on, a multiple of ORL_MAP_BATCHES: n, or as many as go
 * together; returns how many. For shots, and for who counts photons otherwise.
 */
size_t orl_shoot_some(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                      uint64_t n, struct orl_deposits *deposits);

/*
 * Fills shots[kind]; returns 0, ORL_ERR_CANCELLED, ORL_ERR_NOMEM, or ORL_ERR_CORRUPT when no shot
 * stops at had_emitted (photons then freed).
 */
int orl_shoot(const struct orl_shoot_env *env, struct orl_shot shots[ORL_SHOT_KINDS],
              struct orl_error *err);

/* As many emissions as go together, n at most, from one on that is a multiple of ORL_MAP_BATCHES;
 * returns how many. */
struct orl_deposits;
size_t orl_shoot_some(const struct orl_shoot_env *env, enum orl_map_kind kind, uint64_t first,
                      uint64_t n, struct orl_deposits *deposits);

#endif
