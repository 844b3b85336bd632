/*
 * Mist: volumes that absorb and scatter light, between surfaces that light passes as if they did
 * not exist. The surfaces have a geometry of their own. A ray's path through mist lies between its
 * crossings of them; inside is behind the normal. Where volumes overlap, extinctions add up, and
 * each volume scatters its own share.
 *
 * A scattering distance is sampled by the extinction of one of three channels. Weights use the mean
 * pdf of all three (the balance heuristic), so they are at most three. Phase functions are
 * Henyey-Greenstein, sampled exactly.
 *
 * Lengths are metres, extinction is 1/m. References: Henyey and Greenstein 1941; Wilkie et al.,
 * "Hero Wavelength Spectral Sampling", 2014, on weights of several channels.
 */
#ifndef ORL_LIGHT_MIST_H
#define ORL_LIGHT_MIST_H

#include "base/random.h"
#include "light/scene.h"

/* Moves the surfaces of mist from the scene's geometry to one of their own. Returns 0,
 * ORL_ERR_NOMEM, or ORL_ERR_LIMIT. */
int orl_mist_part(struct orl_scene *scene, struct orl_error *err);

/* Returns the share of light that is neither absorbed nor scattered over a distance, which may
 * be infinite. */
struct orl_rgb orl_mist_transmittance(const struct orl_scene *scene, struct orl_vec3 origin,
                                      struct orl_vec3 direction, double distance);

/* A sampled scattering event, or the passage without one, and the path's weight. */
struct orl_mist_event {
    bool scattered;
    /* distance: of the event; forward: parameter of its phase function, -1 to 1 */
    double distance, forward;
    struct orl_rgb weight;
};
struct orl_mist_event orl_mist_meet(const struct orl_scene *scene, struct orl_vec3 origin,
                                    struct orl_vec3 direction, double distance,
                                    struct orl_random *random);

/* Return the phase function, 1/sr, for the cosine between old and new direction, and a direction
 * sampled from it. */
double orl_phase(double forward, double cosine);
struct orl_vec3 orl_phase_sample(double forward, struct orl_vec3 along, const double u[2]);

#endif
