/*
 * The search for pairs of surfaces that may coincide: lists of pairs, a tree of boxes, coplanar
 * polygons and rings, quadrics.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_PAIRS_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENT_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

#include "base/memory/memory.h"
#include "scene/parsed_scene.h"

/* A pair of surfaces, by index. */
struct orl_pair {
    uint32_t a, b;
};

/* A zeroed list is empty; the owner frees the items. */
struct orl_pairs {
    struct orl_pair *items;
    size_t n, room;
};

/* Returns false if out of memory. */
static inline bool orl_pairs_add(struct orl_pairs *pairs, uint32_t a, uint32_t b)
{
    if (!orl_array_reserve(&pairs->items, &pairs->room, pairs->n, sizeof *pairs->items))
        return false;
    pairs->items[pairs->n++] = (struct orl_pair){a, b};
    return true;
}

/*
 * A binary tree of boxes that finds pairs which meet. The time is n log n plus the number of pairs
 * if the boxes are not long and skew. Leaves are in Morton order of the boxes' centres.
 */

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

/*
 * Finds pairs of polygons and rings that lie in one plane and near each other. They are candidates
 * for coincidence, which the caller tests in detail.
 */

/* The scene's extent, and the distance below which surfaces coincide. */
struct orl_coincidence_scale {
    struct orl_vec3 middle;
    double reach, tolerance;
};

/* Number of box comparisons or equivalent work; and its limit. */
struct orl_comparison_budget {
    uint64_t n, most;
};

/* Bounding box of a polygon or ring. */
struct orl_box orl_box_of_flat(const struct orl_surface *surface);
/* Returns true if the boxes of two coplanar surfaces overlap by more than a seam; they may be thin
 * along any one axis. */
bool orl_boxes_overlap(const struct orl_box *a, const struct orl_box *b, double tolerance);

/*
 * Adds the pairs, and counts comparisons; stops at the limit or when cancelled. Polygons of a pair
 * may still be disjoint if they have many corners. If a larger polygon covers one completely, only
 * that pair need be listed. is_cut: by material, true if antimatter cuts it. Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_coplanar_find(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                      struct orl_coincidence_scale *ret_scale, struct orl_pairs *pairs,
                      struct orl_comparison_budget *budget);

/*
 * Coincident quadrics: spheres about one centre, cylinders about one axis that overlap along it,
 * cones with the same ends. Each kind is also compared with its inverted kind.
 */

/* Adds the pairs, and counts comparisons, as orl_coplanar_find does. Returns 0 or ORL_ERR_NOMEM. */
int orl_concentric_find(const struct orl_parsed_scene *parsed_scene,
                        const struct orl_coincidence_scale *scale, struct orl_pairs *pairs,
                        struct orl_comparison_budget *budget);

#endif
