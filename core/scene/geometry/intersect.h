/*
 * Intersection of rays with primitives: by Embree (embree.c, the only file that uses it, version 3
 * or 4), with quadrics in double, and the refinement of Embree's hits on the true surfaces.
 *
 * Included only by the code that builds geometry and by the code that refines hits.
 */
#ifndef ORL_SCENE_GEOMETRY_INTERSECT_H
#define ORL_SCENE_GEOMETRY_INTERSECT_H

#include <stdatomic.h>
#include <stdbool.h>

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

/*
 * Curved and annular surfaces, intersected in double: spheres, cylinders, cones, rings.
 */

/* Finds the nearest intersection with near < t < far; returns t and the declared front normal
 * there. */
bool orl_quadric_intersect(const struct orl_facet *facet, struct orl_vec3 origin,
                           struct orl_vec3 direction, double near, double far, double *ret_t,
                           struct orl_vec3 *ret_normal);

/* The declared front normal at a point of the surface. */
struct orl_vec3 orl_quadric_normal(const struct orl_facet *facet, struct orl_vec3 point);

void orl_quadric_bounds(const struct orl_facet *facet, struct orl_vec3 *ret_low,
                        struct orl_vec3 *ret_high);

double orl_quadric_area(const struct orl_facet *facet);

/* orl_hit_uv for a point of the surface. */
void orl_quadric_uv(const struct orl_facet *facet, struct orl_vec3 point, double ret_uv[2]);

/* Samples a point uniformly by area, with its front normal. */
void orl_quadric_sample(const struct orl_facet *facet, const double u[2],
                        struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal);

/*
 * Refines Embree's hits on the true surfaces, in double, without antimatter. hits.c, above it,
 * takes antimatter into account.
 */

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
