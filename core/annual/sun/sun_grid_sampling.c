#include "annual/sun/sun_grid_sampling.h"

#include <stdlib.h>

#include <oriel/base/error.h>

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
