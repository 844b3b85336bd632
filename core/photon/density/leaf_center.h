/*
 * Where a leaf of a map stands, and an estimate for it can be made: amid its photons. Not at one of
 * them, for there density is known to be higher (the photon itself) or lower (evenly emitted ones
 * keep apart); only when the middle is no place on the surface does a photon's own have to do, and
 * is then left out of the count.
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_CENTER_H
#define ORL_PHOTON_DENSITY_LEAF_CENTER_H

#include "photon/density/search.h"

struct orl_leaf_center {
    float at[3];   /* cells */
    float spread2; /* cells: mean squared distance of the leaf's photons from their middle */
    uint16_t normal;
    bool at_photon;
    uint8_t photon; /* of the leaf: the one it is at, or amid */
    uint32_t facet; /* it lies on, once settled; UINT32_MAX: on none */
};

struct orl_leaf_center orl_leaf_center_make(const struct orl_photon_map *map, uint64_t leaf);
/*
 * Of a leaf whose photons lie uneven, at the edge of a shadow or in two places, it becomes the
 * middle of the half that is closest together, and speaks for that half alone: spread over the
 * whole, what a sun patch holds would light the dark beside it.
 */
void orl_leaf_center_condense(const struct orl_photon_map *map, struct orl_leaf_center *site,
                              uint64_t leaf);
/* Finds its facet; moves it to the photon when there is no surface where it is: of photons of
 * several small ones the middle may lie in a gap between, and an estimate there would spread their
 * light over the gaps. */
void orl_leaf_center_settle(const struct orl_photon_map *map, struct orl_leaf_center *site,
                            uint64_t leaf, const struct orl_world *world);
struct orl_vec3 orl_leaf_center_point(const struct orl_photon_map *map,
                                      const struct orl_leaf_center *site);

/*
 * Puts the query at the site of that leaf, on the surface there when there is one: then true, and
 * ret_footing, which the query refers to, is filled in. With world NULL there is none.
 */
bool orl_leaf_center_ask(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                         uint64_t leaf, const struct orl_world *world,
                         struct orl_density_query *query, struct orl_footing *ret_footing);

#endif
