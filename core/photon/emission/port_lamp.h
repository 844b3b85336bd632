/*
 * Lamps outside as ports see them: photons that start on the pane, with the radiance of a point of
 * the lamp times the transmittance between the two. Paths outwards from a port omit such lamps
 * (orl_port_radiance). Shadow rays from inside count them where the pane transmits straight: their
 * photons are of class ORL_PHOTON_DIRECT, or caustic behind a BSDF.
 *
 * A stratum is a pair of port and lamp. With more than ORL_MOST_PORT_LAMPS pairs a stratum is a
 * port, and each emission chooses one of the lamps with equal probability.
 */
#ifndef ORL_PHOTON_EMISSION_PORT_LAMP_H
#define ORL_PHOTON_EMISSION_PORT_LAMP_H

#include "light/direct.h"
#include "photon/emission/emit.h"

enum { ORL_MOST_PORT_LAMPS = 8192 };
#define ORL_ANY_LAMP UINT32_MAX

/* Lists the lamps before ports that are outside (lamps_outside), in ascending order; in open
 * scenes all lamps before ports. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_port_lamps_find(struct orl_emission *emission, const struct orl_thread_pool *pool);
/* Returns the maximum number of strata for them. */
size_t orl_port_lamp_count_strata(const struct orl_emission *emission);
/* Returns true if that emitter is in lamps_outside. */
bool orl_port_lamp_is_outside(const struct orl_emission *emission, size_t emitter);

/* Returns one estimate of the flux on the pane, W of luma, without occlusion; u: four numbers in
 * [0,1). choice: selects the lamp for ORL_ANY_LAMP. */
double orl_port_lamp_unoccluded_flux(const struct orl_emission *emission,
                                     const struct orl_stratum *stratum, uint32_t choice,
                                     const double u[4]);

/* Returns radiance times solid angle that arrives at a point of the port from a sampled point of
 * the lamp, zero if none; u: two numbers in [0,1). */
struct orl_rgb orl_port_lamp_arriving(const struct orl_emission *emission,
                                      const struct orl_stratum *stratum, struct orl_vec3 point,
                                      const double *u, struct orl_random *random,
                                      uint32_t *ret_lamp, struct orl_light_sample *ret_sample);

/* Returns the focus of a spotlight's beam; 0: it has none. */
double orl_emitter_focus(const struct orl_lit_scene *lit_scene, uint32_t emitter);

#endif
