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
#ifndef ORL_PHOTON_DENSITY_TEXELS_H
#define ORL_PHOTON_DENSITY_TEXELS_H

#include <stdalign.h>

#include "photon/map/batches.h"
#include "photon/surface/footprint.h"

struct orl_texels;

/* Builds the texels. Map and world are borrowed. photons: average number in a texel. Returns
 * NULL if out of memory or the crew is cancelled. */
struct orl_texels *orl_texels_new(const struct orl_photon_map *map,
                                  const struct orl_lit_scene *lit_scene, double photons,
                                  struct orl_thread_pool *pool);
void orl_texels_free(struct orl_texels *texels);

/* Replaces the world by another copy of it, which is borrowed. */
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
