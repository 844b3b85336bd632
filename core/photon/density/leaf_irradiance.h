/*
 * Irradiance by leaf: one density estimate for each leaf of a map, computed at the first request
 * and stored. A final gather may read the same wall a million times; it then pays for one estimate
 * per leaf (16 photons), and a short look-up for each read.
 *
 * A look-up uses the nearest leaf on the same sheet of surface that covers the point. The search
 * starts at the neighbours of the leaf to which the point belongs in the map's order (zorder.h). If
 * that fails it uses the hierarchy of boxes. If the leaf's estimate met a wall, or did not extend
 * to the query point, a ray tests for occluders between the two. If there is one the next leaf is
 * tried, and after some leaves the estimate is computed at the point.
 *
 * A leaf's value depends only on map and scene. So it does not matter which thread computes it
 * first, or whether two do: results are the same for any number of threads. Value (shared-exponent
 * RGB, in one of two units) and clear radius are stored as one 64-bit word, written atomically. Two
 * words with the shares of the emission batches, in 255ths of the largest, are written before it.
 *
 * Reference: Christensen 1999 (precomputed irradiance), here computed on demand.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_IRRADIANCE_H
#define ORL_PHOTON_DENSITY_LEAF_IRRADIANCE_H

#include "photon/density/kernel_density.h"

struct orl_leaf_irradiance;

/*
 * Builds the cache. k and max_radius: parameters of the estimates (kernel_density.h). Map and world
 * are borrowed; if world is NULL, surfaces are taken to be infinite. Returns NULL if out of memory
 * or the crew is cancelled.
 */
struct orl_leaf_irradiance *orl_leaf_irradiance_new(const struct orl_photon_map *map,
                                                    const struct orl_lit_scene *lit_scene,
                                                    uint32_t k, double max_radius,
                                                    struct orl_thread_pool *pool);
void orl_leaf_irradiance_free(struct orl_leaf_irradiance *leaf_irradiance);

/*
 * Replaces map and world by other copies of the same, which are borrowed. Stored estimates remain.
 * No query may run at the same time.
 */
void orl_leaf_irradiance_rebind(struct orl_leaf_irradiance *leaf_irradiance,
                                const struct orl_photon_map *map,
                                const struct orl_lit_scene *lit_scene);
uint64_t
orl_leaf_irradiance_bytes(const struct orl_leaf_irradiance *leaf_irradiance); /* memory, bytes */
/* Returns the approximate share of leaves whose estimate is stored, 0..1, from a sample of them. */
double orl_leaf_irradiance_filled(const struct orl_leaf_irradiance *leaf_irradiance);

/*
 * Returns the irradiance at a point. surface_point: the point's own; NULL: walls are ignored.
 * ret_parts: set to the parts of its luma, or NULL. ret_near_occluded: set to true if the place is
 * occluded in the near field (near_occlusion.h), or NULL. If it is set to true, the irradiance is 0
 * without parts, and the caller must compute it otherwise.
 */
struct orl_rgb orl_leaf_irradiance_estimate(struct orl_leaf_irradiance *leaf_irradiance,
                                            struct orl_vec3 point, struct orl_vec3 normal,
                                            const struct orl_surface_point *surface_point,
                                            struct orl_search *search,
                                            struct orl_batches *ret_parts, bool *ret_near_occluded);

#endif
