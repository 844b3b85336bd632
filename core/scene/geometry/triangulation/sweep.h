/*
 * Triangulates the area that a set of edges encloses by the even-odd rule, by a sweep over an
 * arrangement.
 *
 * The sweep goes up, and at one height to the right. It stores the edges that it cuts from left to
 * right: the area between the first and the second is inside, between the second and the third
 * outside, and so on. Every inside interval is a monotone polygon, triangulated as it grows (Garey,
 * Johnson, Preparata and Tarjan 1978; Lee and Preparata 1977); where one splits or two merge, a
 * diagonal is added. All corners are nodes: none lies on another triangle's side. O(n log n) tests.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_SWEEP_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_SWEEP_H

#include <stdbool.h>

#include "scene/geometry/triangulation/arrangement.h"

struct orl_sweep {
    uint32_t (*triples)[3]; /* nodes, counter-clockwise */
    size_t n_triples, triples_room;
    void *scratch; /* private to sweep.c */
    size_t scratch_room;
};

/* Fills the triples; edges must meet only at their ends, as after orl_arrangement_split.
 * Returns 0, ORL_ERR_NOMEM, or ORL_ERR_INTERNAL if they do not. */
int orl_sweep_triangulate(struct orl_sweep *sweep, const struct orl_arrangement *arrangement);
void orl_sweep_done(struct orl_sweep *sweep); /* accepts a zeroed struct */

/* Grows an array to at least that many items (array: a pointer to it); false if out of memory. */
bool orl_sweep_reserve(void *array, size_t *room, size_t wanted, size_t item);

#endif
