/*
 * Triangulates polygons by the even-odd rule, as Radiance does (a ray's crossing of the plane, and
 * an odd number of edges beside it): seams that run there and back cancel, inner loops are holes in
 * either orientation, and outlines may cross and touch themselves.
 *
 * Convex outlines are cut at their corners, in double. All others go through arrangement.h and
 * sweep.h: places are exact to 2^-29 of the polygon's size. Corners of triangles are corners of the
 * outline or its self-intersections. No corner lies on the side of another triangle.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_TRIANGULATE_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_TRIANGULATE_H

#include "scene/geometry/triangulation/arrangement.h"
#include "scene/geometry/triangulation/sweep.h"

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

#endif
