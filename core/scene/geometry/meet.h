/*
 * Embree's answers on the true surfaces, in double: what rays meet where nothing is cut away.
 * Below hits.c, which asks antimatter too.
 */
#ifndef ORL_SCENE_GEOMETRY_MEET_H
#define ORL_SCENE_GEOMETRY_MEET_H

#include "scene/geometry/embree.h"

/* The hit that Embree has found, on the true surface. */
void orl_meet_settle(const struct orl_geometry *geometry, struct orl_vec3 origin,
                     struct orl_vec3 direction, const struct orl_embree_hit *e,
                     struct orl_hit *ret_hit);

/* Fetches what settling those hits takes, of a geometry that is packed and has polygons of its own
 * alone: from memory that takes longer than all else. */
void orl_meet_expect(const struct orl_geometry *geometry, const struct orl_embree_hit *hits,
                     const bool *found, size_t n);

/* As orl_geometry_intersect, of all surfaces. */
bool orl_meet(const struct orl_geometry *geometry, struct orl_vec3 origin,
              struct orl_vec3 direction, double max_distance, struct orl_hit *ret_hit);

#endif
