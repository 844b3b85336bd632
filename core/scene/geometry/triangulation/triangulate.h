/*
 * Triangulation of polygons: the sweep over an arrangement, its order, and the mesh of corners and
 * quads that results.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_TRIANGULATE_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_TRIANGULATE_H

#include <stdbool.h>

#include "scene/geometry/geometry.h"
#include "scene/geometry/triangulation/arrangement.h"

/*
 * The order in which a sweep, upwards and at one height to the right, visits the nodes and edges of
 * an arrangement.
 */

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

/*
 * Triangulates polygons by the even-odd rule, as Radiance does (a ray's crossing of the plane, and
 * an odd number of edges beside it): seams that run there and back cancel, inner loops are holes in
 * either orientation, and outlines may cross and touch themselves.
 *
 * Convex outlines are cut at their corners, in double. All others go through an arrangement and the
 * sweep: places are exact to 2^-29 of the polygon's size. Corners of triangles are corners of the
 * outline or its self-intersections. No corner lies on the side of another triangle.
 */

/* Scratch, and the result for the last polygon; a zeroed struct is ready to use. */
struct orl_triangulation {
    const struct orl_vec3 *corners; /* the caller's vertices, or `places` */
    /* indices into corners, counter-clockwise about the normal */
    uint32_t (*triples)[3];
    size_t n_triples;                   /* 0: the outline encloses nothing */
    struct orl_arrangement arrangement; /* for outlines that are not convex */
    struct orl_sweep sweep;
    void *ring;
    struct orl_vec3 *places;
    size_t ring_room, places_room;
};

/*
 * normal: unit, by Newell. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT when the outline crosses
 * itself more than ORL_LIMIT_POLYGON_CROSSINGS times.
 */
int orl_triangulate(struct orl_triangulation *t, const struct orl_vec3 *vertices, uint32_t n,
                    struct orl_vec3 normal);
void orl_triangulation_done(struct orl_triangulation *t);

/*
 * Vertices of a geometry while it is built, with duplicates merged: a corner equal to the last bit
 * to a recent one gets that one's index. Duplicates that are not found cost only memory.
 */

struct orl_corners {
    struct orl_geometry *geometry; /* borrowed; owns the corners */
    size_t room;                   /* allocated corners */
    uint32_t *latest;              /* by hash of the place: index of a corner + 1 */
};

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry);
void orl_corners_done(struct orl_corners *corners);

/* Returns the corner's index; false if out of memory. */
bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index);

/*
 * Pairing of a geometry's triangles while it is built (orl_mesh_quad): the two of a quadrilateral,
 * or those of two successive triangular polygons that share an edge. Embree stores and intersects
 * them as quads, in less memory and time than two triangles.
 */

struct orl_quad_builder {
    struct orl_geometry *geometry; /* borrowed; owns the quads */
    size_t room;                   /* allocated quads */
    bool open;                     /* the last quad has room for the next polygon's triangle */
};

/* Adds the triangles of a facet, by their corner indices, and sets the facet's triangle indices.
 * Returns false if out of memory. */
bool orl_quad_builder_add(struct orl_quad_builder *quads, uint32_t facet, uint32_t (*triangles)[3],
                          uint32_t n);

#endif
