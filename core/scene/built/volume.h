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
#ifndef ORL_SCENE_BUILT_VOLUME_H
#define ORL_SCENE_BUILT_VOLUME_H

#include "base/sampling/random.h"
#include "scene/built/scene.h"

/* Moves the surfaces of mist from the scene's geometry to one of their own. Returns 0,
 * ORL_ERR_NOMEM, or ORL_ERR_LIMIT. */
int orl_volume_split(struct orl_scene *scene, struct orl_error *err);

/* Returns the share of light that is neither absorbed nor scattered over a distance, which may
 * be infinite. */
struct orl_rgb orl_volume_transmittance(const struct orl_scene *scene, struct orl_vec3 origin,
                                        struct orl_vec3 direction, double distance);

/* A sampled scattering event, or the passage without one, and the path's weight. */
struct orl_volume_event {
    bool scattered;
    /* distance: of the event; forward: parameter of its phase function, -1 to 1 */
    double distance, asymmetry;
    struct orl_rgb weight;
};
struct orl_volume_event orl_volume_sample_event(const struct orl_scene *scene,
                                                struct orl_vec3 origin, struct orl_vec3 direction,
                                                double distance, struct orl_random *random);

/* Return the phase function, 1/sr, for the cosine between old and new direction, and a direction
 * sampled from it. */
double orl_phase_function(double asymmetry, double cosine);
struct orl_vec3 orl_phase_function_sample(double asymmetry, struct orl_vec3 along,
                                          const double u[2]);

#endif
