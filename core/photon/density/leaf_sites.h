/*
 * Where the leaves of a map stand (leaf_center.h), which of them are beside each other, and which
 * may serve a place. Neighbours are sought when first asked for and kept; who asks first does not
 * matter, so that threads may ask at once.
 *
 * Lengths are in cells of the map (`orl_box_locate`).
 */
#ifndef ORL_PHOTON_DENSITY_LEAF_SITES_H
#define ORL_PHOTON_DENSITY_LEAF_SITES_H

#include <oriel/crew.h>

#include "base/random.h"
#include "photon/density/leaf_center.h"

struct orl_leaf_sites;

/* A leaf and its site's squared distance from a place. */
struct orl_leaf_near {
    float distance2;
    uint32_t leaf;
};

/* No leaf serves beyond max_radius (metres). Map and world are borrowed. NULL: out
 * of memory, or the crew is cancelled. */
struct orl_leaf_sites *orl_leaf_sites_new(const struct orl_photon_map *map,
                                          const struct orl_world *world, double max_radius,
                                          struct orl_crew *crew);
void orl_leaf_sites_free(struct orl_leaf_sites *sites);
/* As orl_leaves_rebind. */
void orl_leaf_sites_rebind(struct orl_leaf_sites *sites, const struct orl_photon_map *map,
                           const struct orl_world *world);
uint64_t orl_leaf_sites_bytes(const struct orl_leaf_sites *sites); /* of memory */

const struct orl_leaf_center *orl_leaf_sites_of(const struct orl_leaf_sites *sites, uint32_t leaf);

/*
 * The leaf whose site is nearest to the point, of those beside the one that it would stand in by
 * the order of the map (zorder.h); false when that one is on another sheet of surface.
 */
bool orl_leaf_sites_about(const struct orl_leaf_sites *sites, struct orl_vec3 point,
                          struct orl_vec3 normal, struct orl_leaf_near *ret_leaf);
/*
 * The nearest leaf whose site is on the point's sheet, of those that come after `last`; false when
 * none is within reach. Found through the hierarchy of boxes.
 */
bool orl_leaf_sites_next(const struct orl_leaf_sites *sites, struct orl_vec3 point,
                         struct orl_vec3 normal, struct orl_leaf_near last,
                         struct orl_leaf_near *ret_next);
/* Whether it may serve the place: it covers that amply, or another one beside it does so, too. */
bool orl_leaf_sites_serve(const struct orl_leaf_sites *sites, struct orl_leaf_near leaf,
                          const float at[3]);
/*
 * A place drawn evenly from a disc about the leaf's site that holds all that the leaf may serve;
 * whether a look-up there finds this leaf.
 */
bool orl_leaf_sites_draw(const struct orl_leaf_sites *sites, uint32_t leaf,
                         struct orl_random *random, struct orl_leaf_center *ret_place);

#endif
