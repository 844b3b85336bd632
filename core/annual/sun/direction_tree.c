#include "annual/sun/direction_tree.h"

#include <stdlib.h>

#include <oriel/base/error.h>

enum { MOST_DEPTH = 64 };

/* ---- Building -------------------------------------------------------------------------------- */

static int widest_axis(const struct orl_direction_entry *entries, size_t count)
{
    int widest = 0;
    double most = -1;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            low = fmin(low, orl_along(entries[i].towards, axis));
            high = fmax(high, orl_along(entries[i].towards, axis));
        }
        if (high - low > most) {
            most = high - low;
            widest = axis;
        }
    }
    return widest;
}

static int compare_along(const void *a, const void *b, void *axis)
{
    const struct orl_direction_entry *x = a, *y = b;
    const double p = orl_along(x->towards, *(int *)axis), q = orl_along(y->towards, *(int *)axis);
    return p != q ? (p < q ? -1 : 1) : (x->index > y->index) - (x->index < y->index);
}

/* Sorts a range and splits it at its median, so the depth is the logarithm of count. */
static void split_range(struct orl_direction_tree *tree, size_t low, size_t high)
{
    if (high <= low)
        return;
    const size_t middle = low + (high - low) / 2;
    int axis = widest_axis(tree->entries + low, high - low);
    qsort_r(tree->entries + low, high - low, sizeof *tree->entries, compare_along, &axis);
    tree->axes[middle] = (unsigned char)axis;
    split_range(tree, low, middle);
    split_range(tree, middle + 1, high);
}

int orl_direction_tree_init(struct orl_direction_tree *tree, orl_direction_of direction,
                            const void *owner, const uint32_t *indices, size_t count)
{
    *tree = (struct orl_direction_tree){.entries = malloc((count + 1) * sizeof *tree->entries),
                                        .axes = malloc(count + 1),
                                        .count = count};
    if (!tree->entries || !tree->axes)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < count; i++) {
        const uint32_t index = indices ? indices[i] : (uint32_t)i;
        tree->entries[i] = (struct orl_direction_entry){direction(owner, index), index};
    }
    split_range(tree, 0, count);
    return 0;
}

void orl_direction_tree_done(struct orl_direction_tree *tree)
{
    free(tree->entries);
    free(tree->axes);
    *tree = (struct orl_direction_tree){.entries = NULL};
}

/* ---- Searching ------------------------------------------------------------------------------- */

/* Directions within an angle of the axis lie in a sphere around its tip, with the chord as
 * radius. */
size_t orl_direction_tree_find(const struct orl_direction_tree *tree, const struct orl_cone *cone,
                               void (*visit)(void *ctx, uint32_t index), void *ctx)
{
    const double chord = sqrt(2 * (1 - cone->cosine)) + 1e-9, least = cone->cosine - 1e-9;
    struct range {
        size_t low, high;
    } stack[MOST_DEPTH] = {{0, tree->count}};
    size_t tested = 0;
    for (int depth = 1; depth > 0;) {
        const struct range r = stack[--depth];
        if (r.high <= r.low)
            continue;
        const size_t middle = r.low + (r.high - r.low) / 2;
        const struct orl_direction_entry *entry = &tree->entries[middle];
        const int axis = tree->axes[middle];
        const double off = orl_along(cone->axis, axis) - orl_along(entry->towards, axis);
        tested++;
        if (orl_dot(entry->towards, cone->axis) >= least)
            visit(ctx, entry->index);
        if (off <= chord)
            stack[depth++] = (struct range){r.low, middle};
        if (off >= -chord)
            stack[depth++] = (struct range){middle + 1, r.high};
    }
    return tested;
}

static struct orl_vec3 direction_of_node(const void *nodes, uint32_t index)
{
    return ((const struct orl_frame *)nodes)[index].n;
}

/* Builds the tree of every stride-th node, from first on; coarse: of every other node of a
 * circle. */
static int make_subset(const struct orl_sun_grid_subsets *subsets, bool coarse, uint32_t stride,
                       uint32_t first, struct orl_direction_tree *ret_tree)
{
    uint32_t *indices = malloc((subsets->n_nodes + 1) * sizeof *indices);
    const uint32_t nodes_per_circle =
        coarse ? (subsets->nodes_per_circle + 1) / 2 : subsets->nodes_per_circle;
    const size_t count = subsets->nodes_per_circle > 0
                             ? subsets->n_nodes / subsets->nodes_per_circle * nodes_per_circle
                             : 0;
    size_t n = 0;
    if (!indices)
        return ORL_ERR_NOMEM;
    for (size_t i = first; i < count; i += stride)
        indices[n++] = (uint32_t)(coarse ? i / nodes_per_circle * subsets->nodes_per_circle +
                                               i % nodes_per_circle * 2
                                         : i);
    const int code =
        orl_direction_tree_init(ret_tree, direction_of_node, subsets->nodes, indices, n);
    free(indices);
    return code;
}

int orl_sun_grid_subsets_init(struct orl_sun_grid_subsets *subsets, const struct orl_frame *nodes,
                              size_t n_nodes, uint32_t nodes_per_circle)
{
    *subsets = (struct orl_sun_grid_subsets){
        .nodes = nodes, .n_nodes = n_nodes, .nodes_per_circle = nodes_per_circle};
    int code = make_subset(subsets, false, 1, 0, &subsets->all);
    for (uint32_t i = 0; i < ORL_SUN_SUBSETS_INSIDE && code == 0; i++)
        code = make_subset(subsets, false, ORL_SUN_SUBSETS_INSIDE, i, &subsets->inside[i]);
    for (uint32_t i = 0; i < ORL_SUN_SUBSETS_OUTSIDE && code == 0; i++)
        code = make_subset(subsets, true, ORL_SUN_SUBSETS_OUTSIDE, i, &subsets->outside[i]);
    return code;
}

void orl_sun_grid_subsets_done(struct orl_sun_grid_subsets *subsets)
{
    orl_direction_tree_done(&subsets->all);
    for (int i = 0; i < ORL_SUN_SUBSETS_INSIDE; i++)
        orl_direction_tree_done(&subsets->inside[i]);
    for (int i = 0; i < ORL_SUN_SUBSETS_OUTSIDE; i++)
        orl_direction_tree_done(&subsets->outside[i]);
}
