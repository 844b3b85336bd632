/*
 * Importance map for photons from the open sky. Over a city block all but a few photons would light
 * the ground and leave; the map sends more to where light stays. For each sun and each patch of the
 * dome it is a table over the scene's box. A pilot estimates for each cell the share of paths that
 * hit surfaces three times more. For caustic photons it is the share of light that is deflected, by
 * the first surface or behind panes. For virtual lamps the importance is the square root of that
 * share, blurred, because a lamp's contribution is either that share or zero. A tenth of the
 * photons is distributed uniformly, so that no light is lost.
 */
#ifndef ORL_PHOTON_EMISSION_EMISSION_IMPORTANCE_H
#define ORL_PHOTON_EMISSION_EMISSION_IMPORTANCE_H

#include "photon/emission/emit.h"

/* Builds the importance maps of an emission whose strata are listed. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_emission_importance_build(struct orl_emission *emission, uint64_t seed,
                                  struct orl_thread_pool *pool);
void orl_emission_importance_done(struct orl_emission *emission);

/* Returns the mean importance of the dome's photons from that direction; 1 if there is no map. */
double orl_emission_importance_mean(const struct orl_emission *emission, struct orl_vec3 towards);

/* Returns the table for light from that direction; NULL if there is none. */
const struct orl_distribution_2d *orl_emission_importance_find(const struct orl_emission *emission,
                                                               const struct orl_stratum *stratum,
                                                               bool caustic,
                                                               struct orl_vec3 towards);

#endif
