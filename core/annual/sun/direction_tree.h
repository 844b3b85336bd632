/* Search for suns: a k-d tree of directions, and the trees of subsets of the sun's nodes. */
#ifndef ORL_ANNUAL_SUN_DIRECTION_TREE_H
#define ORL_ANNUAL_SUN_DIRECTION_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

/* Returns the coordinate of an axis, 0 to 2. */
static inline double orl_along(struct orl_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/*
 * A balanced k-d tree of unit directions: finds those within a cone without testing each of them.
 * The directions are suns; the cone is that of a pane as it is seen from a place.
 *
 * Immutable once built; the directions themselves are copied.
 */

struct orl_direction_entry {
    struct orl_vec3 towards; /* unit */
    uint32_t index;
};

/* Each range is split at its middle entry along the axis axes[middle]. */
struct orl_direction_tree {
    struct orl_direction_entry *entries;
    unsigned char *axes;
    size_t count;
};

/* The directions whose cosine with the unit axis is at least `cosine`; -1: every direction. */
struct orl_cone {
    struct orl_vec3 axis;
    double cosine;
};

/* Returns the cone widened by an angle, given as its sine. */
static inline struct orl_cone orl_cone_widened(struct orl_cone cone, double sine)
{
    const double cosine = sqrt(1 - sine * sine);
    const double own_sine = sqrt(fmax(1 - cone.cosine * cone.cosine, 0));
    cone.cosine = cone.cosine > -cosine ? cone.cosine * cosine - own_sine * sine : -1;
    return cone;
}

/* Returns the direction with the given index from the owner's storage. */
typedef struct orl_vec3 (*orl_direction_of)(const void *owner, uint32_t index);

/* Builds a tree of the directions with the given indices, or of all (indices NULL). Returns 0 or
 * ORL_ERR_NOMEM; orl_direction_tree_done in either case. */
int orl_direction_tree_init(struct orl_direction_tree *tree, orl_direction_of direction,
                            const void *owner, const uint32_t *indices, size_t count);
void orl_direction_tree_done(struct orl_direction_tree *tree);

/* Calls visit with the index of each direction in the cone, in an order that depends on the tree
 * and the cone alone. Returns how many entries were tested. */
size_t orl_direction_tree_find(const struct orl_direction_tree *tree, const struct orl_cone *cone,
                               void (*visit)(void *ctx, uint32_t index), void *ctx);

/*
 * Subsets of the sun's nodes: a place samples the nodes of one subset, weighted by the number of
 * subsets. Inside, a subset is every second node. Outside, where no wall blocks the sun, it is
 * every sixth of every other node of a circle; a node in between gets the mean of its neighbours.
 *
 * Immutable once made.
 */

enum { ORL_SUN_SUBSETS_INSIDE = 2, ORL_SUN_SUBSETS_OUTSIDE = 6 };

struct orl_sun_grid_subsets {
    const struct orl_frame *nodes; /* borrowed; n is towards them */
    size_t n_nodes;
    uint32_t nodes_per_circle;
    struct orl_direction_tree all, inside[ORL_SUN_SUBSETS_INSIDE], outside[ORL_SUN_SUBSETS_OUTSIDE];
};

/* Returns 0 or ORL_ERR_NOMEM; orl_sun_grid_subsets_done in either case. */
int orl_sun_grid_subsets_init(struct orl_sun_grid_subsets *subsets, const struct orl_frame *nodes,
                              size_t n_nodes, uint32_t nodes_per_circle);
void orl_sun_grid_subsets_done(struct orl_sun_grid_subsets *subsets);

#endif
