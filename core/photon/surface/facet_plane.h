/*
 * Flat facets and their triangles in coordinates of their own planes: x along the frame's u and y
 * along v, from the minimum of each.
 *
 * Threads: constant once built, except `has`, which the owner may clear.
 */
#ifndef ORL_PHOTON_SURFACE_FACET_PLANE_H
#define ORL_PHOTON_SURFACE_FACET_PLANE_H

#include "scene/geometry/geometry.h"

struct orl_plane_point {
    double x, y;
};
struct orl_plane_triangle {
    struct orl_plane_point corners[3];
};

/* A facet's plane. */
struct orl_plane {
    struct orl_frame frame;
    struct orl_vec3 origin; /* the facet's corner of minimum x and y */
    double wide, high;
    uint32_t first, triangles; /* range in planes.flats */
};

/* The planes of all facets of the scene's own (not instanced). */
struct orl_planes {
    const struct orl_geometry *geometry;        /* borrowed */
    struct orl_plane *planes;                   /* per facet */
    struct orl_plane_triangle *plane_triangles; /* per triangle, in its facet's plane */
    bool *is_flat;                              /* per facet: it is flat, and not excluded */
};

/* Returns true if a facet has a plane; instanced ones (scene/geometry/instances.h) have none. */
static inline bool orl_planes_has(const struct orl_planes *planes, uint32_t facet)
{
    return !orl_facet_is_instanced(planes->geometry, facet) && planes->is_flat[facet];
}

/* Returns false if out of memory; the caller calls orl_planes_done in any case. */
bool orl_planes_init(struct orl_planes *planes, const struct orl_geometry *geometry);
void orl_planes_done(struct orl_planes *planes);

/* Returns the coordinates of a point in the plane. */
static inline struct orl_plane_point orl_plane_project(const struct orl_plane *plane,
                                                       struct orl_vec3 point)
{
    const struct orl_vec3 way = orl_sub(point, plane->origin);
    return (struct orl_plane_point){orl_dot(way, plane->frame.u), orl_dot(way, plane->frame.v)};
}

/* Returns twice the signed area of a triangle. */
static inline double orl_plane_cross(struct orl_plane_point a, struct orl_plane_point b,
                                     struct orl_plane_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Returns true if a triangle holds a point of its plane; points on its sides belong to it. */
static inline bool orl_plane_triangle_contains(const struct orl_plane_triangle *t,
                                               struct orl_plane_point p)
{
    const double a = orl_plane_cross(t->corners[0], t->corners[1], p);
    const double b = orl_plane_cross(t->corners[1], t->corners[2], p);
    const double c = orl_plane_cross(t->corners[2], t->corners[0], p);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

#endif
