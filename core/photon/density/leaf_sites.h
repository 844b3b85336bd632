/*
 * Positions of a map's leaves (leaf_center.h), their neighbours, and the leaves whose estimate may
 * be used at a point. Neighbours are searched at the first request and stored. The result does not
 * depend on which thread is first, so threads may query at the same time.
 *
 * Lengths are in cells of the map (`orl_box_locate`).
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_SITES_H
#define ORL_PHOTON_DENSITY_LEAF_SITES_H

#include <oriel/base/thread_pool.h>

#include "base/sampling/random.h"
#include "photon/density/leaf_center.h"

struct orl_leaf_sites;

/* A leaf and the squared distance of its site from a point. */
struct orl_near_leaf {
    float distance2;
    uint32_t leaf;
};

/* Builds the sites. No leaf is used beyond max_radius (metres). Map and world are borrowed.
 * Returns NULL if out of memory or the crew is cancelled. */
struct orl_leaf_sites *orl_leaf_sites_new(const struct orl_photon_map *map,
                                          const struct orl_lit_scene *lit_scene, double max_radius,
                                          struct orl_thread_pool *pool);
void orl_leaf_sites_free(struct orl_leaf_sites *sites);
/* Replaces the map and the world, as orl_leaf_irradiance_rebind does. */
void orl_leaf_sites_rebind(struct orl_leaf_sites *sites, const struct orl_photon_map *map,
                           const struct orl_lit_scene *lit_scene);
uint64_t orl_leaf_sites_bytes(const struct orl_leaf_sites *sites); /* memory, bytes */

const struct orl_leaf_center *orl_leaf_sites_of(const struct orl_leaf_sites *sites, uint32_t leaf);

/*
 * Finds the leaf whose site is nearest to the point. Candidates are the neighbours of the leaf to
 * which the point belongs in the map's order (zorder.h). Returns false if that leaf is on another
 * sheet of surface.
 */
bool orl_leaf_sites_nearest(const struct orl_leaf_sites *sites, struct orl_vec3 point,
                            struct orl_vec3 normal, struct orl_near_leaf *ret_leaf);
/*
 * Finds the next leaf after `last`, in order of distance, that has its site on the point's sheet,
 * by the hierarchy of boxes. Returns false if none is within max_radius.
 */
bool orl_leaf_sites_next(const struct orl_leaf_sites *sites, struct orl_vec3 point,
                         struct orl_vec3 normal, struct orl_near_leaf last,
                         struct orl_near_leaf *ret_next);
/* Returns true if the leaf's estimate may be used at the point: the leaf covers it amply, or
 * covers it together with a neighbour. */
bool orl_leaf_sites_cover(const struct orl_leaf_sites *sites, struct orl_near_leaf leaf,
                          const float at[3]);
/*
 * Samples a point uniformly from a disc around the leaf's site that contains all points for which
 * the leaf may be used. Returns true if a look-up at the sampled point finds this leaf.
 */
bool orl_leaf_sites_sample(const struct orl_leaf_sites *sites, uint32_t leaf,
                           struct orl_random *random, struct orl_leaf_center *ret_place);

#endif
