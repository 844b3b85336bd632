/*
 * Irradiance by leaf: the density estimate somewhere in what each leaf of a map serves, made when
 * first asked for and kept. A final gather that asks the same wall a million times then pays for
 * one estimate per leaf (16 photons) and a short look-up each.
 *
 * A look-up takes the nearest leaf on the same sheet of surface that covers the point: sought from
 * the leaf in which the point would stand in the order of the map (zorder.h), which knows the ones
 * beside it, and only where that fails through the hierarchy of boxes. Where the leaf's
 * estimate met a wall, or did not reach as far as the point asked about, a ray tells whether
 * something stands between the two; then the next leaf is tried, and after some the estimate is
 * made at the point.
 *
 * What a leaf holds depends on map and scene alone, so that it does not matter who computes it
 * first, or twice: results are the same for any number of threads. Value (shared-exponent RGB, in
 * one of two units) and clear radius are kept as one 64-bit word, written atomically, after two
 * words of what the batches of emission hold of it, in 255ths of the largest of them.
 *
 * Reference: Christensen 1999 (precomputed irradiance), here lazily.
 */
#ifndef ORL_PHOTON_DENSITY_LEAVES_H
#define ORL_PHOTON_DENSITY_LEAVES_H

#include "photon/density/kernel_density.h"

struct orl_leaves;

/*
 * k and max_radius: of the estimates (kernel_density.h). Map and world are borrowed; with world
 * NULL surfaces are taken to be endless. NULL when out of memory or the crew is cancelled.
 */
struct orl_leaves *orl_leaves_new(const struct orl_photon_map *map, const struct orl_world *world,
                                  uint32_t k, double max_radius, struct orl_crew *crew);
void orl_leaves_free(struct orl_leaves *leaves);

/*
 * From now on they borrow another copy of the same map and of the same world, while nobody asks;
 * estimates made stay.
 */
void orl_leaves_rebind(struct orl_leaves *leaves, const struct orl_photon_map *map,
                       const struct orl_world *world);
uint64_t orl_leaves_bytes(const struct orl_leaves *leaves); /* of memory */
/* What share of them is made, by a look at some. 0..1 */
double orl_leaves_made(const struct orl_leaves *leaves);

/*
 * Irradiance at a point; its footing (the point's own) may be NULL, then walls are not seen.
 * ret_parts is NULL, or takes the parts of its luma; ret_crowded the same, whether the place is
 * crowded (crowd.h): then the irradiance is none and has no parts, for it is to be found otherwise.
 */
struct orl_rgb orl_leaves_irradiance(struct orl_leaves *leaves, struct orl_vec3 point,
                                     struct orl_vec3 normal, const struct orl_footing *footing,
                                     struct orl_search *search, struct orl_batches *ret_parts,
                                     bool *ret_crowded);

#endif
