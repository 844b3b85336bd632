/*
 * The triangles of a geometry while it is built, put together two by two (orl_couple): those of a
 * quadrangle, and those of two polygons of one triangle that follow each other and share an edge.
 * Embree keeps such two in less than it takes for each alone, and meets them sooner.
 */
#ifndef ORL_SCENE_GEOMETRY_COUPLES_H
#define ORL_SCENE_GEOMETRY_COUPLES_H

#include "scene/geometry/geometry.h"

struct orl_couples {
    struct orl_geometry *geometry; /* borrowed; owns what is made */
    size_t room;                   /* of its couples */
    bool open;                     /* the last one's second half may be the next polygon's */
};

/* Adds the triangles of a facet, by their corners, and gives it their numbers. False: out of
 * memory. */
bool orl_couples_add(struct orl_couples *couples, uint32_t facet, uint32_t (*triangles)[3],
                     uint32_t n);

#endif
