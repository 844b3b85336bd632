/*
 * The order in which a sweep, upwards and at one height to the right, visits the nodes and edges of
 * an arrangement.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_SWEEP_ORDER_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_SWEEP_ORDER_H

#include "scene/geometry/triangulation/arrangement.h"

struct orl_sweep_order {
    const struct orl_arrangement *arrangement;
    uint32_t *nodes;       /* in sweep order */
    uint32_t *starts;      /* edges by their low node, and at one node from left to right */
    uint32_t *first_start; /* per node, and one more: index into starts */
    uint32_t *ends;        /* per node: number of edges that end there */
};

/* Returns the number of uint32_t that orl_sweep_order_fill needs. */
size_t orl_sweep_order_words(const struct orl_arrangement *arrangement);
void orl_sweep_order_fill(struct orl_sweep_order *order, const struct orl_arrangement *arrangement,
                          uint32_t *words);

/* Returns how many of n edges, ordered from left to right, lie left of the node. */
size_t orl_sweep_count_left(const struct orl_arrangement *arrangement, const uint32_t *edges,
                            size_t stride, size_t n, uint32_t node);

#endif
