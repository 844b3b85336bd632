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
#ifndef ORL_PHOTON_SHOOTING_PHOTON_PILOT_H
#define ORL_PHOTON_SHOOTING_PHOTON_PILOT_H

#include "photon/shooting/shoot.h"

struct orl_photon_pilot {
    uint64_t emitted[ORL_SHOT_KINDS], stored[ORL_SHOT_KINDS];
    double yield[ORL_SHOT_KINDS]; /* photons stored per emission */
    double rays[ORL_SHOT_KINDS];  /* rays per emission */
    /* seconds per emission, with the whole crew; NaN: no clock */
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
