#include "annual/sun/sun_grid_sampling.h"

#include <stdlib.h>

#include <oriel/error.h>

static struct orl_vec3 direction_of_node(const void *nodes, uint32_t index)
{
    return ((const struct orl_frame *)nodes)[index].n;
}

/* Builds the tree of every stride-th node, from first on; coarse: of every other node of a
 * circle. */
static int make_lot(const struct orl_node_lots *lots, bool coarse, uint32_t stride, uint32_t first,
                    struct orl_direction_tree *ret_tree)
{
    uint32_t *indices = malloc((lots->n_nodes + 1) * sizeof *indices);
    const uint32_t a_circle = coarse ? (lots->a_circle + 1) / 2 : lots->a_circle;
    const size_t count = lots->a_circle > 0 ? lots->n_nodes / lots->a_circle * a_circle : 0;
    size_t n = 0;
    if (!indices)
        return ORL_ERR_NOMEM;
    for (size_t i = first; i < count; i += stride)
        indices[n++] = (uint32_t)(coarse ? i / a_circle * lots->a_circle + i % a_circle * 2 : i);
    const int code = orl_direction_tree_init(ret_tree, direction_of_node, lots->nodes, indices, n);
    free(indices);
    return code;
}

int orl_node_lots_init(struct orl_node_lots *lots, const struct orl_frame *nodes, size_t n_nodes,
                       uint32_t a_circle)
{
    *lots = (struct orl_node_lots){.nodes = nodes, .n_nodes = n_nodes, .a_circle = a_circle};
    int code = make_lot(lots, false, 1, 0, &lots->all);
    for (uint32_t i = 0; i < ORL_LOTS_INSIDE && code == 0; i++)
        code = make_lot(lots, false, ORL_LOTS_INSIDE, i, &lots->inside[i]);
    for (uint32_t i = 0; i < ORL_LOTS_OUTSIDE && code == 0; i++)
        code = make_lot(lots, true, ORL_LOTS_OUTSIDE, i, &lots->outside[i]);
    return code;
}

void orl_node_lots_done(struct orl_node_lots *lots)
{
    orl_direction_tree_done(&lots->all);
    for (int i = 0; i < ORL_LOTS_INSIDE; i++)
        orl_direction_tree_done(&lots->inside[i]);
    for (int i = 0; i < ORL_LOTS_OUTSIDE; i++)
        orl_direction_tree_done(&lots->outside[i]);
}
