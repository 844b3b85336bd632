/*
 * Density by spreading: every photon is spread evenly over a disc of its own, whose size goes with
 * the density where it landed, so that a disc holds about k photons of its kind.
 *
 * What a photon spreads is its flux, no more and no less, whatever the sizes: light is neither made
 * nor lost. The nearest neighbours' estimate (search.h) is not like that. Beside a sun patch its
 * discs reach for the patch's many photons and shrink as they find them, and the dark reads several
 * times too bright, half a percent of the light in a sunny room.
 *
 * All photons of a leaf have one radius, from the median of their distances to their middle and of
 * the leaves beside it. Walls and edges are the asking point's footprint's (footprint.h): for each
 * radius, what is left of the disc.
 *
 * Reference: Silverman 1986, section 5.3 (the adaptive kernel method); Abramson 1982.
 */
#ifndef ORL_PHOTON_DENSITY_KERNEL_DENSITY_H
#define ORL_PHOTON_DENSITY_KERNEL_DENSITY_H

#include "photon/density/search.h"

struct orl_kernel_density;

/* k: photons a disc. The map is borrowed. NULL when out of memory or the crew is cancelled. */
struct orl_kernel_density *orl_kernel_density_new(const struct orl_photon_map *map, uint32_t k,
                                                  double max_radius, struct orl_crew *crew);
void orl_kernel_density_free(struct orl_kernel_density *spread); /* NULL is allowed */

/* From now on it borrows another copy of the map. */
void orl_kernel_density_rebind(struct orl_kernel_density *spread, const struct orl_photon_map *map);
uint64_t orl_kernel_density_bytes(const struct orl_kernel_density *spread); /* of memory */

/* A photon's radius, m: what is normal where it landed. */
double orl_kernel_density_radius(const struct orl_kernel_density *spread, uint32_t photon);

/* Irradiance at query's point; its k and max_radius are not looked at. */
struct orl_density orl_kernel_density_estimate(const struct orl_kernel_density *spread,
                                               const struct orl_density_query *query,
                                               struct orl_search *search);

#endif
