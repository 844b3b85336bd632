/*
 * Irradiance by texels: every flat surface is laid out in squares, the photons that landed in each
 * are added up, and divided by how much of the square is surface. A look-up is an index. No light
 * is made or lost, and none comes through walls; squares that something stands on are marked. What
 * a single square says is noisy and steps at its borders. It is for a final gather, which
 * means over thousands of them.
 *
 * Squares of a side of a facet are as large as holds a number of its photons on average, or as the
 * facet. Photons are traced back to their facets by place and normal, by a ray where that is not
 * plain. Curved surfaces have no texels, nor have those that others coincide with, or that the
 * scene has in several places (scene/geometry/placed.h).
 *
 * Determinism: sums go over photons in the map's order, whatever the crew. Threads: constant once
 * made. Reference: Heckbert 1990 (adaptive radiosity textures).
 */
#ifndef ORL_PHOTON_DENSITY_TEXELS_H
#define ORL_PHOTON_DENSITY_TEXELS_H

#include <stdalign.h>

#include "photon/map/batches.h"
#include "photon/surface/footprint.h"

struct orl_texels;

/* Map and world are borrowed. photons: a texel's, on average. NULL when out of memory or the
 * crew is cancelled. */
struct orl_texels *orl_texels_new(const struct orl_photon_map *map, const struct orl_world *world,
                                  double photons, struct orl_crew *crew);
void orl_texels_free(struct orl_texels *texels);

/* From now on they borrow another copy of the same world. */
void orl_texels_rebind(struct orl_texels *texels, const struct orl_world *world);
uint64_t orl_texels_bytes(const struct orl_texels *texels); /* of memory, but for the facets' */

/*
 * What a texel holds: little, and never across two cache lines, for look-ups wait for memory more
 * than for anything else.
 */
struct orl_texel {
    alignas(32) float irradiance[3]; /* W/m2 */
    uint8_t parts[ORL_MAP_BATCHES];  /* of its luma: shares, in 1/255 that add up to 1 */
};

/* Of a side of a facet: whether it has texels, and how wide they are. */
bool orl_texels_has(const struct orl_texels *texels, uint32_t facet);
double orl_texels_width(const struct orl_texels *texels, uint32_t facet, bool front);

/*
 * At a point of a facet that has texels; NULL where no photon landed. The texel itself is not
 * touched yet: who has others to ask for may fetch it meanwhile. ret_cut: whether something stands
 * on it, so that what it says is of both sides.
 */
const struct orl_texel *orl_texels_at(const struct orl_texels *texels, uint32_t facet, bool front,
                                      struct orl_vec3 point, bool *ret_cut);

#endif
