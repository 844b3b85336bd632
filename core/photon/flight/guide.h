/*
 * Where photons from the open sky are worth most. Over a city block all but a few of them would
 * light the ground and leave; a guide sends more to where light stays: for each way in (a sun, or a
 * patch of the dome) a table over the scene's box, filled by a pilot that finds for each place what
 * share of paths meets surfaces three times more (for caustic photons: what share of light is
 * deflected, by the first thing or behind panes). Photons for virtual lamps go by the root of that
 * share, there and around, for what a lamp brings is that or nothing. One part in ten goes evenly,
 * so that nothing is lost.
 */
#ifndef ORL_PHOTON_FLIGHT_GUIDE_H
#define ORL_PHOTON_FLIGHT_GUIDE_H

#include "photon/flight/emit.h"

/* Fills the emission's guides; the emission's strata must be listed. */
int orl_guide_make(struct orl_emission *emission, uint64_t seed, struct orl_crew *crew);
void orl_guide_done(struct orl_emission *emission);

/* The mean worth of the dome's photons from that direction, once there are guides. */
double orl_guide_worth(const struct orl_emission *emission, struct orl_vec3 towards);

/* The table for light from that direction; NULL while there is none. */
const struct orl_table *orl_guide_find(const struct orl_emission *emission,
                                       const struct orl_stratum *stratum, bool caustic,
                                       struct orl_vec3 towards);

#endif
