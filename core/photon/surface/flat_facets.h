/*
 * Flat facets in coordinates of their planes: a grid of rectangles over each, and the photons that
 * landed on them. Coordinates are x along the frame's u and y along v, from the minimum of each.
 *
 * Threads: planes are constant once built, except is_flat, which the owner may clear.
 */
#ifndef ORL_PHOTON_SURFACE_FLAT_FACETS_H
#define ORL_PHOTON_SURFACE_FLAT_FACETS_H

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>

#include "photon/map/map.h"
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
    uint32_t first, triangles; /* range in planes.plane_triangles */
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

/*
 * A grid of rectangles over a facet's plane: finds the one that a point falls in, and the surface
 * area in each, for any outline of the facet.
 *
 * Threads: pure functions of their arguments.
 */

/* Grid; cells are numbered row by row from `first` on. */
struct orl_facet_grid {
    uint32_t first, columns, rows; /* empty grid: columns is 0 */
    double width, height;          /* size of one cell */
};

/* Returns the number of the cell that holds a point of the plane; beyond the grid, of the
 * nearest one. */
static inline uint32_t orl_facet_grid_index(const struct orl_facet_grid *grid,
                                            struct orl_plane_point at)
{
    const double x = fmin(fmax(at.x / grid->width, 0), grid->columns - 1);
    const double y = fmin(fmax(at.y / grid->height, 0), grid->rows - 1);
    return grid->first + (uint32_t)y * grid->columns + (uint32_t)x;
}

/* Adds to every cell, by its number, the area of the triangles in it. */
void orl_facet_grid_add_areas(const struct orl_facet_grid *grid,
                              const struct orl_plane_triangle *plane_triangles, uint32_t triangles,
                              float *areas);

/* Returns the number of the cell with the most surface, among a cell and its four
 * neighbours. */
uint32_t orl_facet_grid_fullest(const struct orl_facet_grid *grid, const float *areas, uint32_t x,
                                uint32_t y);

/*
 * Assignment of photons to the facets on which they landed: by position and normal among the facets
 * of the photons before, or by a ray if that is ambiguous. For every leaf's first photon a ray is
 * traced, too: if it hits another facet than the one that holds the photon, the two coincide.
 *
 * Determinism: chunks of leaves are functions of the map and the scene. Threads: the work is done
 * by a thread pool.
 */

#define ORL_NO_FACET_SIDE UINT32_MAX

struct orl_photon_facets {
    const struct orl_photon_map *map;
    const struct orl_planes *planes;
    /* per photon: twice its facet, plus one for the front; or ORL_NO_FACET_SIDE */
    uint32_t *places;
    atomic_bool *coincident; /* per facet: another coincides with it */
};

/* Fills places, and marks doubtful facets; both arrays are the caller's. Returns 0 or an error
 * of orl_parallel_try. */
int orl_photon_facets_find(struct orl_photon_facets *photon_facets, struct orl_thread_pool *pool);

/* The position of a photon, and its normal. */
struct orl_stored_photon {
    struct orl_vec3 point, normal;
    uint16_t code; /* code of the normal */
};
struct orl_stored_photon orl_stored_photon_get(const struct orl_photon_map *map, uint64_t index);

#endif
