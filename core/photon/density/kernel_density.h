/*
 * Kernel density estimation: every photon is spread evenly over its own disc. The disc's size
 * follows the density where the photon landed, so that it holds about k photons.
 *
 * A photon spreads exactly its flux, whatever the sizes: light is neither created nor lost. The
 * nearest-neighbour estimate (density_search.h) does not have this property. Beside a sun patch its
 * discs extend to the patch's many photons and shrink when they find them. The dark side reads
 * several times too bright there, half a percent of the light in a sunny room.
 *
 * All photons of a leaf have one radius, from the median of their distances to their centre and
 * those of neighbouring leaves. Walls and edges are taken from the footprint of the query point
 * (footprint.h): the remaining area of the disc for each radius.
 *
 * Reference: Silverman 1986, section 5.3 (the adaptive kernel method); Abramson 1982.
 */
#ifndef ORL_PHOTON_DENSITY_KERNEL_DENSITY_H
#define ORL_PHOTON_DENSITY_KERNEL_DENSITY_H

#include "photon/density/density_search.h"

struct orl_kernel_density;

/* Builds the estimator. k: photons in a disc. Borrows the map. Returns NULL if out of memory or
 * the crew is cancelled. */
struct orl_kernel_density *orl_kernel_density_new(const struct orl_photon_map *map, uint32_t k,
                                                  double max_radius, struct orl_thread_pool *pool);
void orl_kernel_density_free(struct orl_kernel_density *kernel_density); /* NULL is allowed */

/* Replaces the map by another copy of it, which is borrowed. */
void orl_kernel_density_rebind(struct orl_kernel_density *kernel_density,
                               const struct orl_photon_map *map);
uint64_t
orl_kernel_density_bytes(const struct orl_kernel_density *kernel_density); /* memory, bytes */

/* Returns a photon's kernel radius, m, which is the usual one where it landed. */
double orl_kernel_density_radius(const struct orl_kernel_density *kernel_density, uint32_t photon);

/* Returns the irradiance at the query's point; ignores the query's k and max_radius. */
struct orl_density orl_kernel_density_estimate(const struct orl_kernel_density *kernel_density,
                                               const struct orl_density_query *query,
                                               struct orl_search *search);

#endif
