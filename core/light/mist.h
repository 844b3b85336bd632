/*
 * Mist: volumes that dim and scatter what passes, between surfaces that light itself goes through
 * as if they were not there. Those lie in a geometry of their own, and a ray's way through mist is
 * what lies between its crossings of them: inside is behind the normal. Where volumes overlap,
 * extinction adds up, and each scatters its own share.
 *
 * A place of scattering is drawn by the extinction of one channel of three; weights are by the mean
 * density of all three (the balance heuristic), so that they are never more than three. Phase
 * functions are Henyey's and Greenstein's, drawn exactly.
 *
 * Lengths are metres, extinction is 1/m. References: Henyey and Greenstein 1941; Wilkie et al.,
 * "Hero Wavelength Spectral Sampling", 2014, on weights of several channels.
 */
#ifndef ORL_LIGHT_MIST_H
#define ORL_LIGHT_MIST_H

#include "base/random.h"
#include "light/scene.h"

/* The surfaces of mist leave the scene's geometry for one of their own. Returns 0, ORL_ERR_NOMEM,
 * or ORL_ERR_LIMIT. */
int orl_mist_part(struct orl_scene *scene, struct orl_error *err);

/* The share of light that is neither absorbed nor scattered on that way, which may be infinite. */
struct orl_rgb orl_mist_transmittance(const struct orl_scene *scene, struct orl_vec3 origin,
                                      struct orl_vec3 direction, double distance);

/* Where a path along that way is scattered, and its weight there; or has come through. */
struct orl_mist_event {
    bool scattered;
    double distance, forward; /* of the phase function, -1 to 1 */
    struct orl_rgb weight;
};
struct orl_mist_event orl_mist_meet(const struct orl_scene *scene, struct orl_vec3 origin,
                                    struct orl_vec3 direction, double distance,
                                    struct orl_random *random);

/* The density per steradian of light that goes on at that cosine to its way; and a direction. */
double orl_phase(double forward, double cosine);
struct orl_vec3 orl_phase_sample(double forward, struct orl_vec3 along, const double u[2]);

#endif
