/*
 * A balanced k-d tree of unit directions: finds those within a cone without testing each of them.
 * The directions are suns; the cone is that of a pane as it is seen from a place.
 *
 * Immutable once built; the directions themselves are copied.
 */
#ifndef ORL_ANNUAL_DIRECTION_TREE_H
#define ORL_ANNUAL_DIRECTION_TREE_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/vec.h>

struct orl_direction_entry {
    struct orl_vec3 towards; /* unit */
    uint32_t index;          /* of the direction, as it was given */
};

/* The middle entry of a range splits it, along the axis axes[middle]. */
struct orl_direction_tree {
    struct orl_direction_entry *entries;
    unsigned char *axes;
    size_t count;
};

/* All directions less than half_angle away from axis, which is unit. */
struct orl_cone {
    struct orl_vec3 axis;
    double half_angle_rad; /* up to pi */
};

/* The i-th of count directions is read at first + i * stride bytes. Returns 0 or ORL_ERR_NOMEM;
 * orl_direction_tree_done in either case. */
int orl_direction_tree_init(struct orl_direction_tree *tree, const void *first, size_t stride,
                            size_t count);
void orl_direction_tree_done(struct orl_direction_tree *tree);

/* Calls visit with the index of each direction in the cone, in an order that depends on the tree
 * and the cone alone. Returns how many entries were tested. */
size_t orl_direction_tree_find(const struct orl_direction_tree *tree, const struct orl_cone *cone,
                               void (*visit)(void *ctx, uint32_t index), void *ctx);

#endif
