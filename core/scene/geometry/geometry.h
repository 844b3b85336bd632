/*
 * The scene's surfaces for ray tracing, on top of Embree (3 or 4, robust mode); ray hits, samples
 * on facets, and offsets of sensors from surfaces.
 *
 * Coordinates: the scene is moved by -center, in double, before it is converted to Embree's floats.
 * All of the core beyond this header works in these moved coordinates; orl_geometry.center is added
 * or subtracted only at a job's sensors and views. Units are the scene file's.
 *
 * Hits: the point is projected back onto the true surface in double, so that its error does not
 * grow with distance. Rays that start on a surface must start at orl_hit_ray_origin(hit,
 * direction): clear of the surface, and of the geometry that a BSDF with a thickness represents.
 *
 * Instances are stored once (instances.h): indices of their facets and triangles continue beyond
 * the scene's own, arrays do not.
 *
 * Surfaces that antimatter cuts are hit only where they remain (antimatter.h).
 *
 * Where two polygons with opposite fronts coincide, the hit is on the one whose front the ray
 * meets; in all other cases one of the two has been cut away (coincident.h).
 *
 * Triangles are stored in quads: those of a polygon, or of two successive polygons that share an
 * edge. So some triangle indices are unused (orl_triangle_is_unused). In large geometries facets
 * and corners are packed (packed.h): access them by index through the functions below.
 *
 * Determinism: the hierarchy is built by one thread, so that ties are broken the same way each
 * time. Threads: immutable once built; intersect and occluded may be called from any thread.
 */
#ifndef ORL_SCENE_GEOMETRY_GEOMETRY_H
#define ORL_SCENE_GEOMETRY_GEOMETRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "scene/parsed_scene.h"

/* A surface in moved coordinates, with the data that hits need. */
struct orl_facet {
    enum orl_surface_kind kind : 4;
    /* a polygon whose triangles are not coplanar, as rounding of the files' numbers causes */
    bool nonplanar : 1;
    bool has_extra : 1; /* it has an orl_facet_extra */
    unsigned step : 2;  /* polygons: difference between indices of its successive triangles */
    bool has_proxy_offset : 1;  /* orl_facet_proxy_offset is not 0 */
    unsigned n_triangles : 23;  /* polygons; 0 for others */
    uint32_t first_triangle;    /* polygons: see orl_facet_triangle */
    uint32_t material, surface; /* indices into the parsed scene; see orl_facet_surface */
    struct orl_vec3 normal;     /* polygons and rings: unit, the declared front */
    const struct orl_quadric
        *quadric;  /* quadrics and rings: in orl_geometry.quadrics; never NULL */
    double offset; /* distance from the surface at which a ray must start to be clear of it */
    double area;
};

/* Fields that few facets have. */
struct orl_facet_extra {
    uint32_t facet;
    /* into orl_geometry.opposite_facets: coincident facets that face the other way */
    uint32_t first_opposite_facet, n_opposite_facets;
    /* BSDF: distance of the geometry that it represents behind it (negative: in front) */
    double proxy_offset;
};

/*
 * Two triangles with the corners 3 0 1 and 1 2 3; adjacent quads share corners in
 * orl_geometry.corners. Each triangle is listed from its first, second or third corner on. If there
 * is no second triangle, the last two corners are equal.
 */
struct orl_mesh_quad {
    uint32_t corners[4];                        /* must be first: Embree reads them in place */
    uint32_t facet : 27;                        /* facet of the first triangle */
    uint32_t next : 1;                          /* the second triangle belongs to the next facet */
    uint32_t rotation : 2, second_rotation : 2; /* corner from which each triangle is listed */
};

struct orl_triangle {
    struct orl_vec3 a, b, c;
};

/* A triangle expanded from its quad. */
struct orl_indexed_triangle {
    uint32_t corners[3], facet;
};

/* Outline of a polygon that its triangles do not determine (orl_outline_of_facet). */
struct orl_stored_outline {
    uint32_t facet, first, n; /* range in orl_stored_outlines.corners */
};

struct orl_stored_outlines {
    struct orl_stored_outline *items; /* sorted by facet; of every facet if triangles are listed */
    size_t n;
    uint32_t *corners;
    size_t n_corners;
};

struct orl_holes;
struct orl_packed;
struct orl_instance;

struct orl_geometry {
    struct orl_vec3 center;    /* subtracted from the files' coordinates */
    struct orl_vec3 low, high; /* bounds, moved coordinates */
    double radius;             /* radius of the bounding sphere about the moved origin */
    struct orl_facet *facets;  /* NULL if packed */
    size_t n_facets;
    size_t n_unpacked_facets; /* n_facets, or 0 if packed */
    struct orl_quadric
        *quadrics; /* quadrics of the facets that are not polygons, in reverse order */
    size_t n_quadrics;
    struct orl_mesh_quad *quads;
    size_t n_quads;
    struct orl_vec3 *corners; /* NULL if packed */
    size_t n_corners;
    struct orl_packed *packed; /* packed.h; NULL if not packed */
    struct orl_stored_outlines outlines;
    struct orl_facet_extra *extra; /* sorted by facet */
    size_t n_extra;
    uint32_t *opposite_facets;
    size_t n_opposite_facets;
    struct orl_geometry **prototypes; /* owned: instanced geometries (instances.h) */
    size_t n_prototypes;
    struct orl_instance *instance; /* instances */
    size_t n_instances;
    size_t n_uses;           /* in a prototype: number of its instances; else 0 */
    size_t first_use;        /* in a prototype: index of its first instance */
    bool curved;             /* it or an instance has facets that are not polygons */
    struct orl_holes *holes; /* antimatter.h: holes in facets; NULL: none */
    /* triangle index by Embree primitive; NULL: primitives are quads */
    uint32_t *triangle_of_primitive;
    struct orl_indexed_triangle
        *triangle_index; /* expanded triangles; NULL if there are too many */
    double *areas;       /* areas of the triangles; NULL if there are too many */
    void *scene;         /* Embree's scene */
};

/* The first surface along a ray, and the place where materials are evaluated. */
struct orl_hit {
    double distance;
    struct orl_vec3 point;  /* on the surface */
    struct orl_vec3 normal; /* unit, the declared front */
    uint32_t facet;
    uint32_t triangle; /* polygons: index as in orl_triangle_get; else 0 */
    uint32_t instance; /* index of the instance, from 1; 0: none */
    bool front;        /* the ray met the front: dot(direction, normal) < 0 */
};

/*
 * Returns a hit that represents a whole surface with that front normal: materials return their mean
 * over the surface there.
 */
static inline struct orl_hit orl_hit_surface_mean(struct orl_vec3 normal, bool front)
{
    return (struct orl_hit){.normal = normal, .instance = UINT32_MAX, .front = front};
}
static inline bool orl_hit_is_surface_mean(const struct orl_hit *hit)
{
    return hit->instance == UINT32_MAX;
}

/* instances.c: returns a triangle of an instance, whose index is beyond the scene's own. */
struct orl_triangle orl_instance_triangle(const struct orl_geometry *geometry, size_t index);

/* packed.c (_packed): facets, corners and triangles that are packed. facets.c (_slow): facets that
 * are packed or belong to instances. */
const struct orl_facet *orl_facet_get_packed(const struct orl_geometry *geometry, size_t facet,
                                             struct orl_facet *room);
double orl_facet_area_packed(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_surface_packed(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_surface_slow(const struct orl_geometry *geometry, size_t facet);
const struct orl_facet *orl_facet_get_slow(const struct orl_geometry *geometry, size_t facet,
                                           struct orl_facet *room);
enum orl_surface_kind orl_facet_kind_slow(const struct orl_geometry *geometry, size_t facet);
uint32_t orl_facet_material_slow(const struct orl_geometry *geometry, size_t facet);
double orl_facet_clearance_slow(const struct orl_geometry *geometry, uint32_t facet, double side);
double orl_facet_offset_slow(const struct orl_geometry *geometry, size_t facet);
struct orl_vec3 orl_corner_get_packed(const struct orl_geometry *geometry, size_t corner);
struct orl_triangle orl_triangle_get_packed(const struct orl_geometry *geometry, size_t index);

/* Returns true if the facet belongs to an instance (instances.h). */
static inline bool orl_facet_is_instanced(const struct orl_geometry *geometry, size_t facet)
{
    return facet >= geometry->n_facets;
}

/* Returns one of the scene's own facets, without its surface. If facets are packed, it is written
 * to *room. */
static inline const struct orl_facet *orl_facet_get_own(const struct orl_geometry *geometry,
                                                        size_t facet, struct orl_facet *room)
{
    return geometry->facets ? &geometry->facets[facet]
                            : orl_facet_get_packed(geometry, facet, room);
}

/* Returns any facet. For instances it is the prototype's, of which only kind, material and area are
 * valid. */
static inline const struct orl_facet *orl_facet_get(const struct orl_geometry *geometry,
                                                    size_t facet, struct orl_facet *room)
{
    return facet < geometry->n_unpacked_facets ? &geometry->facets[facet]
                                               : orl_facet_get_slow(geometry, facet, room);
}

static inline struct orl_vec3 orl_facet_normal(const struct orl_geometry *geometry, size_t facet)
{
    struct orl_facet own;
    return orl_facet_get_own(geometry, facet, &own)->normal;
}

static inline double orl_facet_area(const struct orl_geometry *geometry, size_t facet)
{
    return geometry->facets ? geometry->facets[facet].area : orl_facet_area_packed(geometry, facet);
}

/* These work for instances, too: surface, kind and material are the prototype's. */
static inline uint32_t orl_facet_surface(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_unpacked_facets ? geometry->facets[facet].surface
                                               : orl_facet_surface_slow(geometry, facet);
}

static inline enum orl_surface_kind orl_facet_kind(const struct orl_geometry *geometry,
                                                   size_t facet)
{
    return facet < geometry->n_unpacked_facets ? geometry->facets[facet].kind
                                               : orl_facet_kind_slow(geometry, facet);
}

static inline uint32_t orl_facet_material(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_unpacked_facets ? geometry->facets[facet].material
                                               : orl_facet_material_slow(geometry, facet);
}

static inline double orl_facet_offset(const struct orl_geometry *geometry, size_t facet)
{
    return facet < geometry->n_unpacked_facets ? geometry->facets[facet].offset
                                               : orl_facet_offset_slow(geometry, facet);
}

/* Distances below this are rounding errors; no facet's offset is more than a quarter of it. */
static inline double orl_geometry_resolution(const struct orl_geometry *geometry)
{
    return geometry->radius * 0x1p-18;
}

/* Sets a facet's material; must precede all queries of it. */
void orl_facet_set_material(struct orl_geometry *geometry, size_t facet, uint32_t material);

static inline struct orl_vec3 orl_corner_get(const struct orl_geometry *geometry, size_t corner)
{
    return geometry->corners ? geometry->corners[corner] : orl_corner_get_packed(geometry, corner);
}

/* Returns an upper bound of triangle indices. */
static inline size_t orl_geometry_triangles_end(const struct orl_geometry *geometry)
{
    return 2 * geometry->n_quads;
}

/* Returns the index of a polygon's i-th triangle. */
static inline uint32_t orl_facet_triangle(const struct orl_facet *facet, uint32_t i)
{
    return facet->first_triangle + i * facet->step;
}

/* The functions below are for the scene's own triangles only. */
static inline bool orl_triangle_is_unused(const struct orl_geometry *geometry, size_t index)
{
    const struct orl_mesh_quad *const quad = &geometry->quads[index / 2];
    return index % 2 == 1 && quad->corners[2] == quad->corners[3];
}

static inline uint32_t orl_mesh_quad_facet(const struct orl_mesh_quad *quad, bool second)
{
    return quad->facet + (second ? quad->next : 0U);
}

static inline uint32_t orl_triangle_facet(const struct orl_geometry *geometry, size_t index)
{
    return geometry->triangle_index ? geometry->triangle_index[index].facet
                                    : orl_mesh_quad_facet(&geometry->quads[index / 2], index % 2);
}

/* Returns the index of a triangle's k-th corner. */
static inline uint32_t orl_triangle_corner(const struct orl_geometry *geometry, size_t index,
                                           unsigned k)
{
    static const uint8_t order[2][5] = {{3, 0, 1, 3, 0}, {1, 2, 3, 1, 2}};
    if (geometry->triangle_index)
        return geometry->triangle_index[index].corners[k];
    const struct orl_mesh_quad *const quad = &geometry->quads[index / 2];
    const unsigned rotation = index % 2 ? quad->second_rotation : quad->rotation;
    return quad->corners[order[index % 2][rotation + k]];
}

static inline struct orl_triangle orl_triangle_get_own(const struct orl_geometry *geometry,
                                                       size_t index)
{
    const struct orl_vec3 *const corners = geometry->corners;
    if (!corners)
        return orl_triangle_get_packed(geometry, index);
    return (struct orl_triangle){corners[orl_triangle_corner(geometry, index, 0)],
                                 corners[orl_triangle_corner(geometry, index, 1)],
                                 corners[orl_triangle_corner(geometry, index, 2)]};
}

static inline double orl_triangle_area(const struct orl_triangle *t)
{
    return 0.5 * orl_length(orl_cross(orl_sub(t->b, t->a), orl_sub(t->c, t->a)));
}

/*
 * Returns true if there are so many triangles that memory per triangle matters more than time.
 */
static inline bool orl_geometry_is_vast(const struct orl_geometry *geometry)
{
    return geometry->n_quads >= 1 << 16;
}

/* A polygon's corners in the files' order; only for the scene's own polygons with an area. */
struct orl_facet_outline {
    const struct orl_vec3 *corners; /* the geometry's; NULL if packed */
    const uint32_t *own;            /* indices of the corners; NULL: they are in `at` */
    uint32_t n, at[4];
    const struct orl_geometry *geometry;
};
struct orl_facet_outline orl_outline_of_facet_slow(const struct orl_geometry *geometry,
                                                   uint32_t facet);
static inline struct orl_facet_outline orl_outline_of_facet(const struct orl_geometry *geometry,
                                                            uint32_t facet)
{
    if (!geometry->triangle_index)
        return orl_outline_of_facet_slow(geometry, facet);
    const struct orl_stored_outline *const own = &geometry->outlines.items[facet];
    struct orl_facet_outline outline; /* leaves the unused fields uninitialised */
    outline.corners = geometry->corners;
    outline.own = geometry->outlines.corners + own->first;
    outline.n = own->n;
    return outline;
}

static inline struct orl_vec3 orl_outline_corner(const struct orl_facet_outline *outline,
                                                 uint32_t i)
{
    const uint32_t corner = outline->own ? outline->own[i] : outline->at[i];
    return outline->corners ? outline->corners[corner]
                            : orl_corner_get_packed(outline->geometry, corner);
}

static inline struct orl_triangle orl_triangle_get(const struct orl_geometry *geometry,
                                                   size_t index)
{
    return index < orl_geometry_triangles_end(geometry) ? orl_triangle_get_own(geometry, index)
                                                        : orl_instance_triangle(geometry, index);
}

/* Expands triangles from quads, and lists the outlines of all facets, unless there are too many.
 * Returns false if out of memory. */
bool orl_geometry_index_triangles(struct orl_geometry *geometry);

/* Returns the number of the scene's own triangles. */
size_t orl_geometry_count_triangles(const struct orl_geometry *geometry);

/* Prepares a thread; see orl_prepare_thread (oriel/job/run.h). */
int orl_geometry_prepare_thread(struct orl_error *err);

/* Returns 0 and a geometry the caller frees, or ORL_ERR_NOMEM, ORL_ERR_RANGE. */
int orl_geometry_new(const struct orl_parsed_scene *parsed_scene,
                     struct orl_geometry **ret_geometry, struct orl_error *err);
void orl_geometry_free(struct orl_geometry *geometry);

/* Finds the nearest surface along the ray within max_distance; direction is unit. */
bool orl_geometry_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                            struct orl_vec3 direction, double max_distance,
                            struct orl_hit *ret_hit);

struct orl_ray {
    struct orl_vec3 origin, direction; /* unit */
};

/*
 * Finds the first hit of each of many rays, as orl_geometry_intersect does without a distance
 * limit. Rays through an edge may hit either side of it. alike: all rays have about the same
 * direction, which is several times faster (slower if untrue).
 */
void orl_geometry_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                                 size_t n, bool alike, struct orl_hit *ret_hits, bool *ret_found);

/* Returns true if any surface, glass included, lies within max_distance. */
bool orl_geometry_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                           struct orl_vec3 direction, double max_distance);

/* Returns true if antimatter may remove parts of the facet. */
bool orl_geometry_is_cut(const struct orl_geometry *geometry, uint32_t facet);

/*
 * Copies a geometry without instances so that rays hit only the facets for which `remains` is true;
 * the others keep their index but have no area. Returns 0 and a geometry that the caller frees, or
 * ORL_ERR_NOMEM.
 */
int orl_geometry_subset(const struct orl_geometry *whole, const bool *remains,
                        struct orl_geometry **ret_geometry, struct orl_error *err);

/* Returns the extra fields of one of the scene's own facets with has_extra. */
const struct orl_facet_extra *orl_facet_extra_of(const struct orl_geometry *geometry,
                                                 uint32_t facet);

static inline double orl_facet_proxy_offset(const struct orl_geometry *geometry, uint32_t facet)
{
    struct orl_facet own;
    return orl_facet_get_own(geometry, facet, &own)->has_proxy_offset
               ? orl_facet_extra_of(geometry, facet)->proxy_offset
               : 0;
}

/* Returns the origin of a ray that leaves a point on a facet with that front normal along
 * direction. */
static inline struct orl_vec3 orl_facet_ray_origin(const struct orl_geometry *geometry,
                                                   uint32_t facet, struct orl_vec3 point,
                                                   struct orl_vec3 normal,
                                                   struct orl_vec3 direction)
{
    const double side = orl_dot(direction, normal) >= 0 ? 1 : -1;
    if (facet >= geometry->n_unpacked_facets)
        return orl_madd(point, normal, side * orl_facet_clearance_slow(geometry, facet, side));
    const struct orl_facet *f = &geometry->facets[facet];
    /* On the side of the geometry that it represents, rays start beyond that geometry. */
    const double proxy_offset =
        f->has_proxy_offset ? orl_facet_extra_of(geometry, facet)->proxy_offset : 0;
    const double hidden = proxy_offset * side < 0 ? fabs(proxy_offset) : 0;
    return orl_madd(point, normal, side * (f->offset + hidden));
}

/* The normal on the ray's side. */
static inline struct orl_vec3 orl_hit_facing(const struct orl_hit *hit)
{
    return hit->front ? hit->normal : orl_neg(hit->normal);
}

/* Returns the origin of a ray that leaves the hit along direction. */
static inline struct orl_vec3 orl_hit_ray_origin(const struct orl_geometry *geometry,
                                                 const struct orl_hit *hit,
                                                 struct orl_vec3 direction)
{
    return orl_facet_ray_origin(geometry, hit->facet, hit->point, hit->normal, direction);
}

/*
 * Computes the texture coordinates of a hit. On a polygon's triangle: the barycentric coordinates
 * of its corners b and c. On quadrics: the angle about the axis (0 to 1, from an arbitrary start)
 * and the position along it: from the first centre to the second, from a sphere's lowest point to
 * its highest, from a ring's inner rim to its outer one.
 */
void orl_hit_uv(const struct orl_geometry *geometry, const struct orl_hit *hit, double ret_uv[2]);

/* Samples a point uniformly by area on a facet, with its front normal; u in [0,1)^2.
 * orl_facet_sample_many is for the scene's own facets only. */
void orl_facet_sample(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                      struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal);
void orl_facet_sample_many(const struct orl_geometry *geometry, uint32_t facet,
                           const double (*u)[2], size_t n, struct orl_vec3 *ret_points);

/*
 * Offsets of sensors from surfaces. A sensor on a surface, or up to a tenth of a millimetre below
 * it, is moved in front of it; other sensors stay where they are. The offset depends on that
 * surface only: a ground wider than a town must not lift the sensors of a room by a millimetre,
 * across the edge of a shadow.
 */

/* Returns the origin of a sensor's rays for that (moved) point; normal, unit, is its viewing
 * direction. */
struct orl_vec3 orl_offset_from_surface(const struct orl_geometry *geometry, struct orl_vec3 point,
                                        struct orl_vec3 normal);

/* The nearest surface that a point touches within the geometry's resolution. */
struct orl_surface_contact {
    uint32_t facet;
    double distance;
};

/* Returns false if the point is clear of all surfaces. */
bool orl_find_surface_contact(const struct orl_geometry *geometry, struct orl_vec3 point,
                              struct orl_surface_contact *ret_touch);

#endif
