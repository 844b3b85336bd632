/*
 * Leaves of a map as places: the point of a leaf at which its estimate is made, and its neighbours.
 *
 * The point of a leaf is the centre of its photons. It is not a photon's own position, because
 * density there is known to be higher (the photon itself) or lower (stratified photons keep apart).
 * Only if the centre is not on the surface is a photon's position used; that photon is then
 * excluded from the estimate.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_SITES_H
#define ORL_PHOTON_DENSITY_LEAF_SITES_H

#include <oriel/base/thread_pool.h>

#include "base/sampling/sampling.h"
#include "photon/density/density_estimate.h"
#include "photon/surface/footprint.h"

struct orl_leaf_center {
    float at[3]; /* in cells */
    /* squared cells: mean squared distance of the leaf's photons from their centre */
    float spread2;
    uint16_t normal;
    bool at_photon;
    /* index in the leaf of the photon at the point or in the middle of the leaf */
    uint8_t photon;
    /* the facet that it lies on, set by orl_leaf_center_find_facet; UINT32_MAX: none */
    uint32_t facet;
};

struct orl_leaf_center orl_leaf_center_make(const struct orl_photon_map *map, uint64_t leaf);
/*
 * Handles a leaf with unevenly spaced photons, as at the edge of a shadow or in two places. The
 * point becomes the centre of the densest half and represents that half only. Otherwise the photons
 * of a sun patch would be spread over the whole leaf and light the dark beside it.
 */
void orl_leaf_center_use_densest(const struct orl_photon_map *map, struct orl_leaf_center *site,
                                 uint64_t leaf);
/* Finds the facet of the point. If there is no surface, moves the point to the photon. The
 * centre of photons on several small surfaces may lie in a gap, and an estimate there would
 * spread their light over the gaps. */
void orl_leaf_center_find_facet(const struct orl_photon_map *map, struct orl_leaf_center *site,
                                uint64_t leaf, const struct orl_lit_scene *lit_scene);
struct orl_vec3 orl_leaf_center_point(const struct orl_photon_map *map,
                                      const struct orl_leaf_center *site);

/*
 * Places the query at the leaf's point, on the surface if there is one. Returns true if there is
 * one; then ret_surface_point, which the query refers to, is filled in. If lit_scene is NULL, there
 * is none.
 */
bool orl_leaf_center_set_query(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                               uint64_t leaf, const struct orl_lit_scene *lit_scene,
                               struct orl_density_query *query,
                               struct orl_surface_point *ret_surface_point);

/*
 * Positions of a map's leaves, their neighbours, and the leaves whose estimate may be used at a
 * point. Neighbours are searched at the first request and stored. The result does not depend on
 * which thread is first, so threads may query at the same time.
 *
 * Lengths are in cells of the map (`orl_box_locate`).
 */

struct orl_leaf_sites;

/* A leaf and the squared distance of its site from a point. */
struct orl_near_leaf {
    float distance2;
    uint32_t leaf;
};

/* Builds the sites. No leaf is used beyond max_radius (metres). Map and lit scene are borrowed.
 * Returns NULL if out of memory or the pool is cancelled. */
struct orl_leaf_sites *orl_leaf_sites_new(const struct orl_photon_map *map,
                                          const struct orl_lit_scene *lit_scene, double max_radius,
                                          struct orl_thread_pool *pool);
void orl_leaf_sites_free(struct orl_leaf_sites *sites);
/* Replaces the map and the lit scene, as orl_leaf_irradiance_rebind does. */
void orl_leaf_sites_rebind(struct orl_leaf_sites *sites, const struct orl_photon_map *map,
                           const struct orl_lit_scene *lit_scene);
uint64_t orl_leaf_sites_bytes(const struct orl_leaf_sites *sites); /* memory, bytes */

const struct orl_leaf_center *orl_leaf_sites_of(const struct orl_leaf_sites *sites, uint32_t leaf);

/*
 * Finds the leaf whose site is nearest to the point. Candidates are the neighbours of the leaf to
 * which the point belongs in the map's order (map_layout.h). Returns false if that leaf is on
 * another sheet of surface.
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
