/*
 * Pairing of a geometry's triangles while it is built (orl_mesh_quad): the two of a quadrilateral,
 * or those of two successive triangular polygons that share an edge. Embree stores and intersects
 * them as quads, in less memory and time than two triangles.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_MESH_QUADS_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_MESH_QUADS_H

#include "scene/geometry/geometry.h"

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
