/*
 * A binary tree of boxes for pairs that meet: n log n and the number of pairs, for boxes that are
 * not long and skew. Leaves follow a curve through the boxes' middles (Morton's order).
 */
#ifndef ORL_SCENE_GEOMETRY_BOX_TREE_H
#define ORL_SCENE_GEOMETRY_BOX_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/vec.h>

struct orl_box {
    struct orl_vec3 low, high;
};

/* No axis has a gap wider than pad between them. */
bool orl_boxes_meet(const struct orl_box *a, const struct orl_box *b, double pad);

struct orl_box_node {
    struct orl_box box;
    int64_t last; /* the largest number of a box below, or -1 */
};

/* Zeroed is empty. */
struct orl_box_tree {
    struct orl_box_node *nodes; /* the root is 1, children of k are 2 k and 2 k + 1 */
    size_t n_leaves;            /* a power of two */
    uint32_t *found;            /* result: numbers in ascending order */
    size_t n_found, room;
};

/* Boxes are numbered from 0 in the order they are in, stride bytes apart. Returns false when out of
 * memory. */
bool orl_box_tree_build(struct orl_box_tree *tree, const struct orl_box *boxes, size_t stride,
                        size_t n);

/* Finds the boxes of larger numbers than after, -1 for all, that meet the box, and adds the nodes
 * visited to visits. Returns false when out of memory. */
bool orl_box_tree_find(struct orl_box_tree *tree, const struct orl_box *box, int64_t after,
                       double pad, uint64_t *visits);
void orl_box_tree_done(struct orl_box_tree *tree);

#endif
