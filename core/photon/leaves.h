/*
 * Irradiance by leaf: the density estimate amid the photons of each leaf of a map, made when first
 * asked for and kept. A final gather that asks the same wall a million times then pays for
 * one estimate per leaf (16 photons) and a short look-up each.
 *
 * What a leaf holds depends on the map alone, so that it does not matter who computes it first,
 * or twice: results are the same for any number of threads. Values are kept as one 32-bit word
 * (shared-exponent RGB), written atomically.
 *
 * Reference: Christensen 1999 (precomputed irradiance), here lazily.
 */
#ifndef ORL_PHOTON_LEAVES_H
#define ORL_PHOTON_LEAVES_H

#include "photon/search.h"

struct orl_leaves;

/* k and max_radius: of the estimates. The map is borrowed. NULL when out of memory. */
struct orl_leaves *orl_leaves_new(const struct orl_photon_map *map, uint32_t k, double max_radius);
void orl_leaves_free(struct orl_leaves *leaves);

/* Irradiance of the nearest leaf on the same sheet of surface; by density where there is none. */
struct orl_rgb orl_leaves_irradiance(struct orl_leaves *leaves, struct orl_vec3 point,
                                     struct orl_vec3 normal, struct orl_search *search);

#endif
