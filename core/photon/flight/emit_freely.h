/*
 * Emissions that pass no port: from local emitters, and from the sky of an open scene. Their
 * photons fly as they start (emit.h).
 */
#ifndef ORL_PHOTON_FLIGHT_EMIT_FREELY_H
#define ORL_PHOTON_FLIGHT_EMIT_FREELY_H

#include "photon/flight/emit.h"

/* Fill in the members of a flight that depend on the emitter; u: five numbers in [0,1) as for
 * orl_emission_from. Return false if no photon is emitted. */
bool orl_emit_from_lamp(const struct orl_emission *emission, const struct orl_stratum *stratum,
                        const double *u, struct orl_flight *ret_flight);
bool orl_emit_from_sky(const struct orl_emission *emission, const struct orl_stratum *stratum,
                       bool caustic, const double *u, struct orl_flight *ret_flight);

#endif
