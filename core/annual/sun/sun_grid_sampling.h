/*
 * Subsets of the sun's nodes: a place samples the nodes of one subset, weighted by the number of
 * subsets. Inside, a subset is every second node. Outside, where no wall blocks the sun, it is
 * every sixth of every other node of a circle; a node in between gets the mean of its neighbours.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_SUN_GRID_SAMPLING_H
#define ORL_ANNUAL_SUN_SUN_GRID_SAMPLING_H

#include <stdbool.h>

#include "annual/sun/direction_tree.h"

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
