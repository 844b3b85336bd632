/*
 * Refines Embree's hits on the true surfaces, in double, without antimatter. hits.c, above it,
 * takes antimatter into account.
 */
#ifndef ORL_SCENE_GEOMETRY_HIT_REFINEMENT_H
#define ORL_SCENE_GEOMETRY_HIT_REFINEMENT_H

#include "scene/geometry/embree.h"

/* Refines a hit that Embree has found. */
void orl_hit_refine(const struct orl_geometry *geometry, struct orl_vec3 origin,
                    struct orl_vec3 direction, const struct orl_embree_hit *e,
                    struct orl_hit *ret_hit);

/* Prefetches the data for refining hits of a packed geometry that has only polygons of its own;
 * these memory reads dominate the time. */
void orl_hit_prefetch(const struct orl_geometry *geometry, const struct orl_embree_hit *hits,
                      const bool *found, size_t n);

/* orl_geometry_intersect with all surfaces, cut or not. */
bool orl_intersect_uncut(const struct orl_geometry *geometry, struct orl_vec3 origin,
                         struct orl_vec3 direction, double max_distance, struct orl_hit *ret_hit);

#endif
