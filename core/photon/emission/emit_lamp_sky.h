/*
 * Emissions that pass no port: from local emitters, and from the sky of an open scene. Their
 * photons fly as they start (emit.h).
 */
#ifndef ORL_PHOTON_EMISSION_EMIT_LAMP_SKY_H
#define ORL_PHOTON_EMISSION_EMIT_LAMP_SKY_H

#include "photon/emission/emit.h"

/* Fill in the members of a photon ray that depend on the emitter; u: five numbers in [0,1) as for
 * orl_emission_sample_stratum. Return false if no photon is emitted. */
bool orl_emit_from_lamp(const struct orl_emission *emission, const struct orl_stratum *stratum,
                        const double *u, struct orl_photon_ray *ret_photon_ray);
bool orl_emit_from_sky(const struct orl_emission *emission, const struct orl_stratum *stratum,
                       bool caustic, const double *u, struct orl_photon_ray *ret_photon_ray);

#endif
