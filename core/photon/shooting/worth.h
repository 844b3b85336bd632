/*
 * What caustic photons would be worth, and what they would take: a pilot of both kinds before there
 * is a map of either.
 *
 * Photons of a kind come to nothing mostly where surfaces hardly mirror, or are small and far from
 * where light starts: then a photon that is stored takes tens of emissions. Whether that is worth
 * it depends on how much of the light is caustic, and on how much of it where it lands: a spot of
 * sun through a lens outshines all else where it lies, however small its flux; the gleam of a desk
 * on a lit ceiling is lost in what is there anyway. The first asks for sharp edges and little
 * noise; the second is the same picture with a hundredth of the photons.
 *
 * Contrast is measured where pilot photons lie, in cubes about each caustic one that are as small
 * as still hold some, of each kind by itself, so that a small spot counts by its own brightness.
 *
 * The pilot is seeded and sized by counts: the same for any crew.
 */
#ifndef ORL_PHOTON_SHOOTING_WORTH_H
#define ORL_PHOTON_SHOOTING_WORTH_H

#include "photon/shooting/shoot.h"

struct orl_worth {
    uint64_t emitted[ORL_SHOT_KINDS], stored[ORL_SHOT_KINDS];
    double yield[ORL_SHOT_KINDS];      /* photons stored per emission */
    double rays[ORL_SHOT_KINDS];       /* per emission */
    double emission_s[ORL_SHOT_KINDS]; /* that one takes, by the whole crew; NaN: no clock */
    double share;    /* of all light that lands, reflected light included, what is caustic */
    double contrast; /* its share of the light where it lands, on average over it; 0..1 */
    bool known;      /* enough caustic photons were found to tell */
};

/*
 * env: its progress is not told; by_chance: of caustic photons it takes those alone (trace.h).
 * now_s: NULL, or a clock. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_worth_measure(const struct orl_shoot_env *env, double (*now_s)(void *ctx), void *ctx,
                      struct orl_worth *ret_worth, struct orl_error *err);

/* The contrast of caustic photons, fluxes per emission scaled by those factors; of `rest` those of
 * class ORL_PHOTON_CAUSTIC do not count. Returns a negative orl_err when out of memory. */
int orl_worth_contrast(const struct orl_photon *caustic, size_t n_caustic, double caustic_scale,
                       const struct orl_photon *rest, size_t n_rest, double rest_scale,
                       const struct orl_geometry *geometry, double *ret_contrast);

#endif
