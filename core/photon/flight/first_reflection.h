/*
 * What light falls on first that a map does not keep: light of suns and lamps is counted by shadow
 * rays and caustic photons, and maps that are seen directly begin with its first reflection
 * (omit.counted_light). Were all of it emitted as photons of one flux, most would end on that first
 * surface and leave nothing.
 *
 * So such strata emit fewer photons, of more flux each: by the mean albedo of the surfaces that
 * they fall on first, as the light that goes on sees them. The photon pays there what it was
 * spared: it survives with its albedo over that mean, and loses flux by the mean alone, so that
 * what it leaves weighs what others do. On brighter surfaces it goes on surely, and is heavier.
 * Any number here is right on average; a good one is quick.
 */
#ifndef ORL_PHOTON_FLIGHT_FIRST_REFLECTION_H
#define ORL_PHOTON_FLIGHT_FIRST_REFLECTION_H

#include <oriel/crew.h>

#include "photon/flight/emit.h"

/*
 * Fills in `reflected` of all strata, by pilot flights; 1 where all light is kept. Returns 0 or
 * ORL_ERR_CANCELLED.
 */
int orl_first_reflection_prepare(struct orl_emission *emission, uint64_t seed,
                                 struct orl_crew *crew);

#endif
