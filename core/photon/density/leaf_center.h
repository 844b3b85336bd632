/*
 * The point of a leaf of a map at which an estimate for it can be made: the centre of its photons.
 * It is not a photon's own position, because density there is known to be higher (the photon
 * itself) or lower (stratified photons keep apart). Only if the centre is not on the surface is a
 * photon's position used; that photon is then excluded from the estimate.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_CENTER_H
#define ORL_PHOTON_DENSITY_LEAF_CENTER_H

#include "photon/density/density_search.h"

struct orl_leaf_center {
    float at[3]; /* in cells */
    /* squared cells: mean squared distance of the leaf's photons from their centre */
    float spread2;
    uint16_t normal;
    bool at_photon;
    /* index in the leaf of the photon at the point or in the middle of the leaf */
    uint8_t photon;
    uint32_t facet; /* the facet that it lies on, once settled; UINT32_MAX: none */
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
 * one; then ret_surface_point, which the query refers to, is filled in. If world is NULL, there is
 * none.
 */
bool orl_leaf_center_set_query(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                               uint64_t leaf, const struct orl_lit_scene *lit_scene,
                               struct orl_density_query *query,
                               struct orl_surface_point *ret_surface_point);

#endif
