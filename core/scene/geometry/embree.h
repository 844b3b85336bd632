/*
 * The only file that uses Embree, version 3 (Debian 12) or 4 (later releases).
 * Included only by the code that builds geometry and by the code that refines hits.
 */
#ifndef ORL_SCENE_GEOMETRY_EMBREE_H
#define ORL_SCENE_GEOMETRY_EMBREE_H

#include <stdatomic.h>

#include "scene/geometry/geometry.h"

/* Prepares Embree's state of this thread (embree_device.h). */
int orl_embree_prepare(struct orl_error *err);

/* Builds a scene of geometry's triangles (first), curved facets and instances. Returns
 * ORL_ERR_CANCELLED once *cancel is set; cancel may be NULL. */
int orl_embree_build(struct orl_geometry *geometry, const atomic_bool *cancel,
                     struct orl_error *err);
void orl_embree_free(struct orl_geometry *geometry);

/* Embree's hit. index: of a triangle, or of a facet if curved; for instances, the index in the
 * prototype. */
struct orl_embree_hit {
    double distance;
    uint32_t index;
    bool curved;
    bool seam;         /* near the common edge of a quad: the other triangle is possible */
    uint32_t instance; /* index of the instance, from 1; 0: none */
};

bool orl_embree_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                          struct orl_vec3 direction, double max_distance,
                          struct orl_embree_hit *ret_hit);
/* Traces many rays without a distance limit, as orl_geometry_intersect_many does. */
void orl_embree_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                               size_t n, bool alike, struct orl_embree_hit *ret_hits,
                               bool *ret_found);
bool orl_embree_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                         struct orl_vec3 direction, double max_distance);

#endif
