/*
 * Curved and annular surfaces, intersected in double: spheres, cylinders, cones, rings.
 */
#ifndef ORL_SCENE_GEOMETRY_QUADRIC_H
#define ORL_SCENE_GEOMETRY_QUADRIC_H

#include <stdbool.h>

#include "scene/geometry/geometry.h"

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

#endif
