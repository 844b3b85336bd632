/*
 * Irradiance of a global map tabulated for a final gather: by leaf, computed at the first request;
 * and by texels of flat surfaces, computed at once.
 *
 * Irradiance by leaf is one density estimate for each leaf of a map, computed at the first request
 * and stored. A final gather may read the same wall a million times; it then pays for one estimate
 * per leaf (16 photons), and a short look-up for each read.
 *
 * A look-up uses the nearest leaf on the same sheet of surface that covers the point. The search
 * starts at the neighbours of the leaf to which the point belongs in the map's order
 * (map_layout.h). If that fails it uses the hierarchy of boxes. If the leaf's estimate met a wall,
 * or did not extend to the query point, a ray tests for occluders between the two. If there is one
 * the next leaf is tried, and after some leaves the estimate is computed at the point.
 *
 * A leaf's value depends only on map and scene. So it does not matter which thread computes it
 * first, or whether two do: results are the same for any number of threads. Value (shared-exponent
 * RGB, in one of two units) and clear radius are stored as one 64-bit word, written atomically. Two
 * words with the shares of the emission batches, in 255ths of the largest, are written before it.
 *
 * Reference: Christensen 1999 (precomputed irradiance), here computed on demand.
 */
#ifndef ORL_PHOTON_DENSITY_IRRADIANCE_TABLES_H
#define ORL_PHOTON_DENSITY_IRRADIANCE_TABLES_H

#include <stdalign.h>

#include "photon/density/density_estimate.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

struct orl_leaf_irradiance;

/*
 * Builds the cache. k and max_radius: parameters of the estimates (orl_kernel_density_new). Map and
 * lit scene are borrowed; if lit_scene is NULL, surfaces are taken to be infinite. Returns NULL if
 * out of memory or the pool is cancelled.
 */
struct orl_leaf_irradiance *orl_leaf_irradiance_new(const struct orl_photon_map *map,
                                                    const struct orl_lit_scene *lit_scene,
                                                    uint32_t k, double max_radius,
                                                    struct orl_thread_pool *pool);
void orl_leaf_irradiance_free(struct orl_leaf_irradiance *leaf_irradiance);

/*
 * Replaces map and lit scene by other copies of the same, which are borrowed. Stored estimates
 * remain. No query may run at the same time.
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
 * occluded in the near field (leaf_irradiance.c), or NULL. If it is set to true, the irradiance is
 * 0 without parts, and the caller must compute it otherwise.
 */
struct orl_rgb orl_leaf_irradiance_estimate(struct orl_leaf_irradiance *leaf_irradiance,
                                            struct orl_vec3 point, struct orl_vec3 normal,
                                            const struct orl_surface_point *surface_point,
                                            struct orl_search *search,
                                            struct orl_batches *ret_parts, bool *ret_near_occluded);

/*
 * Irradiance by texels: every flat surface is divided into rectangles, and the flux of the photons
 * in each is summed and divided by its surface area. A look-up is an array access. Light is neither
 * created nor lost, and none passes through walls; texels with an object standing on them are
 * marked. A single texel is noisy and has steps at its borders. Texels are for a final gather,
 * which averages over thousands of them.
 *
 * The texels on one side of a facet are so large that they hold a given number of its photons on
 * average, but not larger than the facet. Photons are assigned to their facets by position and
 * normal, or by a ray if these are ambiguous. Curved surfaces, coincident ones and instanced ones
 * (scene/geometry/instances.h) have no texels.
 *
 * Determinism: sums are taken in the map's order of photons, for any number of threads. Threads:
 * constant once made. Reference: Heckbert 1990 (adaptive radiosity textures).
 */

struct orl_texels;

/* Builds the texels. Map and lit scene are borrowed. photons: average number in a texel. Returns
 * NULL if out of memory or the pool is cancelled. */
struct orl_texels *orl_texels_new(const struct orl_photon_map *map,
                                  const struct orl_lit_scene *lit_scene, double photons,
                                  struct orl_thread_pool *pool);
void orl_texels_free(struct orl_texels *texels);

/* Replaces the lit scene by another copy of it, which is borrowed. */
void orl_texels_rebind(struct orl_texels *texels, const struct orl_lit_scene *lit_scene);
/* memory, bytes, without the planes of facets */
uint64_t orl_texels_bytes(const struct orl_texels *texels);

/*
 * A texel. It is small and never crosses two cache lines, because look-ups are limited by memory
 * latency.
 */
struct orl_texel {
    alignas(32) float irradiance[3]; /* W/m2 */
    /* parts of its luma by batch: shares in 1/255 that add up to 1 */
    uint8_t parts[ORL_MAP_BATCHES];
};

/* Return whether a facet has texels, and how wide they are on one side of it. */
bool orl_texels_has(const struct orl_texels *texels, uint32_t facet);
double orl_texels_width(const struct orl_texels *texels, uint32_t facet, bool front);

/*
 * Returns the texel at a point of a facet that has texels; NULL if no photon landed on that side.
 * Does not read the texel, so that a caller with several look-ups can prefetch them. *ret_cut: true
 * if an object stands on the texel, so that it mixes the light of both sides of it.
 */
const struct orl_texel *orl_texels_at(const struct orl_texels *texels, uint32_t facet, bool front,
                                      struct orl_vec3 point, bool *ret_cut);

#endif
