/*
 * The one place that knows Embree: version 3 (Debian 12) and 4 (later releases) alike.
 * Included by what builds geometry and by what settles hits alone.
 */
#ifndef ORL_SCENE_GEOMETRY_EMBREE_H
#define ORL_SCENE_GEOMETRY_EMBREE_H

#include <stdatomic.h>

#include "scene/geometry/geometry.h"

/* Embree's state of this thread (embree_device.h). */
int orl_embree_prepare(struct orl_error *err);

/* Builds a scene from geometry's triangles (first), curved facets and what is placed. Heeds *cancel
 * (ORL_ERR_CANCELLED) unless it is NULL. */
int orl_embree_build(struct orl_geometry *geometry, const atomic_bool *cancel,
                     struct orl_error *err);
void orl_embree_free(struct orl_geometry *geometry);

/* What a ray met: a triangle's index, or a facet's when curved; of what is placed those in its
 * prototype. */
struct orl_embree_hit {
    double distance;
    uint32_t index;
    bool curved;
    bool seam;       /* it may be the other of a couple, whose edge is near */
    uint32_t placed; /* which of those, from 1; 0: none */
};

bool orl_embree_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                          struct orl_vec3 direction, double max_distance,
                          struct orl_embree_hit *ret_hit);
/* Many at once, to any distance, as orl_geometry_intersect_many has them. */
void orl_embree_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                               size_t n, bool alike, struct orl_embree_hit *ret_hits,
                               bool *ret_found);
bool orl_embree_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                         struct orl_vec3 direction, double max_distance);

#endif
