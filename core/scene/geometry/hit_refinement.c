#include "scene/geometry/intersect.h"

#include "scene/geometry/instances.h"
#include "scene/geometry/packed.h"

/* Returns true if a point in the facet's plane lies on it, rim included; *ret_triangle: on which
 * triangle. */
static bool contains_point(const struct orl_geometry *geometry, const struct orl_facet *facet,
                           struct orl_vec3 point, uint32_t *ret_triangle)
{
    const double slack = -facet->offset;
    for (uint32_t i = 0; i < facet->n_triangles; i++) {
        *ret_triangle = orl_facet_triangle(facet, i);
        const struct orl_triangle t = orl_triangle_get_own(geometry, *ret_triangle);
        const struct orl_vec3 corners[4] = {t.a, t.b, t.c, t.a};
        bool inside = true;
        for (int k = 0; k < 3 && inside; k++) {
            const struct orl_vec3 side = orl_sub(corners[k + 1], corners[k]);
            const struct orl_vec3 across = orl_cross(facet->normal, side);
            inside = orl_dot(orl_sub(point, corners[k]), across) >= slack * orl_length(side);
        }
        if (inside)
            return true;
    }
    return false;
}

/* Replaces a hit on a back by one on the front of an opposite facet. */
static void choose_front(const struct orl_geometry *geometry, struct orl_hit *hit)
{
    const struct orl_facet_extra *const extra = orl_facet_extra_of(geometry, hit->facet);
    for (uint32_t i = 0; i < extra->n_opposite_facets; i++) {
        const uint32_t opposite = geometry->opposite_facets[extra->first_opposite_facet + i];
        uint32_t triangle;
        struct orl_facet own;
        const struct orl_facet *const f = orl_facet_get_own(geometry, opposite, &own);
        if (!contains_point(geometry, f, hit->point, &triangle))
            continue;
        hit->facet = opposite;
        hit->triangle = triangle;
        hit->normal = f->normal;
        hit->front = true;
        return;
    }
}

/* Returns a facet whether packed or not; of *room only the fields that hits need are set. */
static inline const struct orl_facet *facet_of(const struct orl_geometry *geometry, uint32_t facet,
                                               bool packed, struct orl_facet *room)
{
    if (!packed)
        return &geometry->facets[facet];
    const struct orl_packed_facet *const f = &geometry->packed->facets[facet];
    room->nonplanar = f->nonplanar;
    room->has_extra = f->has_extra;
    room->normal = orl_packed_normal(f);
    room->offset = orl_packed_offset(f);
    return room;
}

static inline struct orl_vec3 corner_of(const struct orl_geometry *geometry, uint32_t triangle,
                                        bool packed)
{
    const uint32_t corner = orl_triangle_corner(geometry, triangle, 0);
    return packed ? orl_packed_corner(geometry->packed, corner) : geometry->corners[corner];
}

/* Returns a normal (not unit) of the plane of a hit. A bent polygon's mean plane may be on the far
 * side of the triangle that Embree hit. */
static inline struct orl_vec3 plane_of(const struct orl_geometry *geometry,
                                       const struct orl_facet *facet, uint32_t triangle)
{
    if (!facet->nonplanar)
        return facet->normal;
    const struct orl_triangle t = orl_triangle_get_own(geometry, triangle);
    return orl_cross(orl_sub(t.b, t.a), orl_sub(t.c, t.a));
}

/* Returns the distance along the ray to a triangle's plane. */
static double exact_distance(const struct orl_geometry *geometry, struct orl_vec3 origin,
                             struct orl_vec3 direction, uint32_t index)
{
    struct orl_facet own;
    const struct orl_facet *const facet =
        facet_of(geometry, orl_triangle_facet(geometry, index), geometry->packed, &own);
    const struct orl_vec3 plane = plane_of(geometry, facet, index);
    const struct orl_vec3 corner = corner_of(geometry, index, geometry->packed);
    return orl_dot(orl_sub(corner, origin), plane) / orl_dot(direction, plane);
}

/* Chooses the triangle at the common edge of a quad, where Embree's numbers are ambiguous: for
 * two polygons, the one whose plane is at the hit distance. */
static __attribute__((noinline)) uint32_t choose_half(const struct orl_geometry *geometry,
                                                      struct orl_vec3 origin,
                                                      struct orl_vec3 direction,
                                                      const struct orl_embree_hit *e)
{
    const uint32_t first = e->index & ~1U, second = e->index | 1U;
    if (orl_triangle_is_unused(geometry, second))
        return first;
    const double a = fabs(exact_distance(geometry, origin, direction, first) - e->distance);
    const double b = fabs(exact_distance(geometry, origin, direction, second) - e->distance);
    return orl_triangle_facet(geometry, first) == orl_triangle_facet(geometry, second) ? e->index
           : a <= b                                                                    ? first
                                                                                       : second;
}

static inline __attribute__((always_inline)) void
refine_own(const struct orl_geometry *geometry, struct orl_vec3 origin, struct orl_vec3 direction,
           const struct orl_embree_hit *e, bool packed, struct orl_hit *ret_hit)
{
    const uint32_t met = e->seam ? choose_half(geometry, origin, direction, e) : e->index;
    const uint32_t index = e->curved ? met : orl_triangle_facet(geometry, met);
    struct orl_facet own;
    const struct orl_facet *facet = facet_of(geometry, index, packed, &own);
    double t = e->distance;
    struct orl_vec3 normal = facet->normal;
    if (e->curved) {
        if (packed)
            facet = orl_facet_get_packed(geometry, index, &own);
        /* Solves again in double. At grazing incidence there may be no root: then Embree's hit
         * counts. */
        if (!orl_quadric_intersect(facet, origin, direction, 0.5 * t, 2 * t, &t, &normal))
            normal = orl_quadric_normal(facet, orl_madd(origin, direction, t));
    } else {
        const struct orl_vec3 plane = plane_of(geometry, facet, met);
        const struct orl_vec3 corner = corner_of(geometry, met, packed);
        const double slope = orl_dot(direction, plane);
        const double exact = orl_dot(orl_sub(corner, origin), plane) / slope;
        if (fabs(exact - t) <= 1e-3 * t + facet->offset)
            t = exact;
    }
    ret_hit->distance = t;
    ret_hit->point = orl_madd(origin, direction, t);
    ret_hit->normal = normal;
    ret_hit->facet = index;
    ret_hit->triangle = e->curved ? 0 : met;
    ret_hit->instance = 0;
    ret_hit->front = orl_dot(direction, normal) < 0;
    if (!ret_hit->front && facet->has_extra)
        choose_front(geometry, ret_hit);
}

/* Out of line, like the next function, because nearly no scene needs either. */
static __attribute__((noinline)) void
refine_packed(const struct orl_geometry *geometry, struct orl_vec3 origin,
              struct orl_vec3 direction, const struct orl_embree_hit *e, struct orl_hit *ret_hit)
{
    refine_own(geometry, origin, direction, e, true, ret_hit);
}

/* Refines the hit in the prototype's coordinates, and transforms it back. */
static __attribute__((noinline)) void
refine_placed(const struct orl_geometry *geometry, struct orl_vec3 origin,
              struct orl_vec3 direction, const struct orl_embree_hit *e, struct orl_hit *ret_hit)
{
    const struct orl_instance *const instance = &geometry->instance[e->instance - 1];
    const struct orl_embree_hit inside = {e->distance / instance->to.scale, e->index, e->curved,
                                          e->seam, 0};
    const struct orl_vec3 from = orl_xform_point(&instance->from, origin);
    const struct orl_vec3 along = orl_xform_direction(&instance->from, direction);
    if (instance->prototype->packed)
        refine_packed(instance->prototype, from, along, &inside, ret_hit);
    else
        refine_own(instance->prototype, from, along, &inside, false, ret_hit);
    orl_instance_hit(geometry, instance, origin, direction, ret_hit);
}

static inline __attribute__((always_inline)) void
refine_hit(const struct orl_geometry *geometry, struct orl_vec3 origin, struct orl_vec3 direction,
           const struct orl_embree_hit *e, struct orl_hit *ret_hit)
{
    if (e->instance > 0)
        refine_placed(geometry, origin, direction, e, ret_hit);
    else if (geometry->packed)
        refine_packed(geometry, origin, direction, e, ret_hit);
    else
        refine_own(geometry, origin, direction, e, false, ret_hit);
}

void orl_hit_prefetch(const struct orl_geometry *geometry, const struct orl_embree_hit *hits,
                      const bool *found, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (found[i])
            __builtin_prefetch(&geometry->quads[hits[i].index / 2]);
    for (size_t i = 0; i < n; i++) {
        if (!found[i])
            continue;
        const uint32_t corner = orl_triangle_corner(geometry, hits[i].index, 0);
        __builtin_prefetch(&geometry->packed->facets[orl_triangle_facet(geometry, hits[i].index)]);
        __builtin_prefetch(geometry->packed->high[corner]);
        __builtin_prefetch(geometry->packed->low[corner]);
    }
}

void orl_hit_refine(const struct orl_geometry *geometry, struct orl_vec3 origin,
                    struct orl_vec3 direction, const struct orl_embree_hit *e,
                    struct orl_hit *ret_hit)
{
    refine_hit(geometry, origin, direction, e, ret_hit);
}

bool orl_intersect_uncut(const struct orl_geometry *geometry, struct orl_vec3 origin,
                         struct orl_vec3 direction, double max_distance, struct orl_hit *ret_hit)
{
    struct orl_embree_hit e;
    if (!orl_embree_intersect(geometry, origin, direction, max_distance, &e))
        return false;
    refine_hit(geometry, origin, direction, &e, ret_hit);
    return true;
}
