/* Flights that find which strata give caustics, and how many caustic photons each is to have. */
#ifndef ORL_PHOTON_FLIGHT_CAUSTIC_PILOT_H
#define ORL_PHOTON_FLIGHT_CAUSTIC_PILOT_H

#include <oriel/crew.h>

#include "photon/flight/emit.h"

/* Of an emission whose strata are listed: sets their share_caustic and place, and has_caustics.
 * ORL_ERR_NOMEM, _CANCELLED. */
int orl_caustic_pilot(struct orl_emission *emission, uint64_t seed, struct orl_crew *crew);

#endif
