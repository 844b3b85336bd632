/*
 * A binary tree of boxes that finds pairs which meet. The time is n log n plus the number of pairs
 * if the boxes are not long and skew. Leaves are in Morton order of the boxes' centres.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_BOX_TREE_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_BOX_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

struct orl_box {
    struct orl_vec3 low, high;
};

/* Returns true if the boxes are no further apart than pad along each axis. */
bool orl_boxes_meet(const struct orl_box *a, const struct orl_box *b, double pad);

struct orl_box_node {
    struct orl_box box;
    int64_t last; /* largest box index in the subtree, or -1 */
};

/* A zeroed tree is empty. */
struct orl_box_tree {
    struct orl_box_node *nodes; /* the root is 1, children of k are 2 k and 2 k + 1 */
    size_t n_leaves;            /* a power of two */
    uint32_t *found;            /* result: numbers in ascending order */
    size_t n_found, room;
};

/* Box i is at i * stride bytes. Returns false if out of memory. */
bool orl_box_tree_build(struct orl_box_tree *tree, const struct orl_box *boxes, size_t stride,
                        size_t n);

/* Finds the boxes that meet the given box and have an index above `after` (-1 for all); adds the
 * nodes visited to *visits. Returns false if out of memory. */
bool orl_box_tree_find(struct orl_box_tree *tree, const struct orl_box *box, int64_t after,
                       double pad, uint64_t *visits);
void orl_box_tree_done(struct orl_box_tree *tree);

#endif
