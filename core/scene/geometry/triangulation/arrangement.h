/*
 * Arrangements of polygon outlines on an integer grid, for triangulate.c and coincident.c.
 *
 * A polygon's corners, projected into its plane, are snapped to a grid of 2^29 steps to either side
 * (a 10 m wall: 0.02 um). Edges are then split wherever they cross, touch or overlap, until they
 * share only their ends; of coincident edges an even number cancels. All tests are exact in
 * integers. Points where edges cross are rounded to the grid, as by snap rounding (Hobby 1999):
 * edges that come within a step of a corner are moved to it.
 *
 * Cost: a sweep finds out whether any edges meet (Shamos and Hoey 1976), in O(n log n), again after
 * each splitting. Small sets are tested pair by pair, and so is a set in its third pass. Crossings
 * are bounded by ORL_LIMIT_POLYGON_CROSSINGS, and work to about a second.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_ARRANGEMENT_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_ARRANGEMENT_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

struct orl_node {
    int32_t x, y;
    struct orl_vec3 place; /* the corner as given; for crossings, a point on one of the edges */
};

/* low is the lower node (less y, then less x). layers: one bit for each outline that has this
 * edge. */
struct orl_edge {
    uint32_t low, high, layers;
};

struct orl_arrangement {
    struct orl_frame frame;
    struct orl_vec3 middle;
    double step; /* grid spacing */
    struct orl_node *nodes;
    size_t n_nodes, nodes_room;
    struct orl_edge *edges;
    size_t n_edges, edges_room;
    uint32_t *table; /* open-addressing hash of nodes by grid position: index + 1 */
    size_t table_size;
    void *scratch[4]; /* private to arrangement.c */
    size_t scratch_room[4];
    uint64_t tests; /* pairs of edges tested since orl_arrangement_begin */
};

/* Empties the arrangement and sets its grid: the plane through middle, reach to all sides. */
void orl_arrangement_begin(struct orl_arrangement *a, struct orl_vec3 normal,
                           struct orl_vec3 middle, double reach);
/* Adds a closed outline as layer 1, 2, 4, ... Returns 0 or ORL_ERR_NOMEM. */
int orl_arrangement_add(struct orl_arrangement *a, const struct orl_vec3 *vertices, uint32_t n,
                        uint32_t layer);
/* Splits and cancels. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT: too many crossings. */
int orl_arrangement_split(struct orl_arrangement *a);
void orl_arrangement_done(struct orl_arrangement *a); /* accepts a zeroed struct */

/* Twice the signed area of three nodes. */
static inline int64_t orl_node_turn(const struct orl_node *a, const struct orl_node *b,
                                    const struct orl_node *c)
{
    return ((int64_t)b->x - a->x) * ((int64_t)c->y - a->y) -
           ((int64_t)b->y - a->y) * ((int64_t)c->x - a->x);
}

static inline int orl_node_compare(const struct orl_node *a, const struct orl_node *b)
{
    if (a->y != b->y)
        return a->y < b->y ? -1 : 1;
    return a->x < b->x ? -1 : a->x > b->x;
}

#endif
