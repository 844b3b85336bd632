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

#include <oriel/base/input_checks.h>

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
    bool unsampled_only; /* only for pilots (orl_photon_pilot_run): as in orl_deposits */
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
 * stops at earlier_emitted; on failure photons are freed.
 */
int orl_shoot(const struct orl_shoot_env *env, struct orl_shot shots[ORL_SHOT_KINDS],
              struct orl_error *err);

/*
 * Pilot of caustic photons before there is any map: their contribution and their cost.
 *
 * Few emissions lead to a caustic photon if surfaces hardly mirror, or are small and far from where
 * light starts: a stored photon then takes tens of emissions. Whether that cost is justified
 * depends on the caustics' share of all light, and on their share of the light where they land
 * (contrast). A spot of sun through a lens outshines all other light where it lies, however small
 * its flux. The reflection of a desk on a lit ceiling is invisible in the light that is there. The
 * first requires sharp edges and little noise; the second looks the same with a hundredth of the
 * photons.
 *
 * Contrast is measured at the pilot photons, in cubes around each caustic one. The cubes are as
 * small as still hold some photons, separately for each kind, so that a small spot counts with its
 * own brightness.
 *
 * The pilot is seeded and sized by counts: the same for any number of threads.
 */

struct orl_photon_pilot {
    uint64_t emitted[ORL_SHOT_KINDS], stored[ORL_SHOT_KINDS];
    double yield[ORL_SHOT_KINDS]; /* photons stored per emission */
    double rays[ORL_SHOT_KINDS];  /* rays per emission */
    /* seconds per emission, with the whole pool; NaN: no clock */
    double emission_s[ORL_SHOT_KINDS];
    /* caustic flux over the flux of all light that lands, reflected light included */
    double share;
    double contrast; /* mean share of caustic light where it lands; 0..1 */
    bool known;      /* enough caustic photons were found for a result */
};

/*
 * Runs the pilot. env: its progress callback is not called; unsampled_only: as in orl_deposits.
 * now_s: a clock, or NULL. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_photon_pilot_run(const struct orl_shoot_env *env, double (*now_s)(void *ctx), void *ctx,
                         struct orl_photon_pilot *ret_pilot, struct orl_error *err);

/* Computes the contrast of caustic photons. The scales convert fluxes to those per emission.
 * Photons of class ORL_PHOTON_CAUSTIC in `rest` are ignored. Returns 0 or ORL_ERR_NOMEM. */
int orl_photon_pilot_contrast(const struct orl_photon *caustic, size_t n_caustic,
                              double caustic_scale, const struct orl_photon *rest, size_t n_rest,
                              double rest_scale, const struct orl_geometry *geometry,
                              double *ret_contrast);

#endif
