/* Ray hits with antimatter taken into account; samples on facets; offsets from surfaces. */
#include "scene/geometry/antimatter/antimatter.h"
#include "scene/geometry/instances.h"
#include "scene/geometry/intersect.h"

enum { AT_ONCE = 64 }; /* rays traced together */

/* Skips hits that antimatter has removed; each facet is passed a few times at most. */
static bool intersect_remaining(const struct orl_geometry *geometry, struct orl_vec3 origin,
                                struct orl_vec3 direction, double max_distance,
                                struct orl_hit *ret_hit)
{
    const size_t most = 2 * geometry->n_facets + 2 * orl_geometry_triangles_end(geometry);
    struct orl_vec3 from = origin;
    double gone = 0;
    for (size_t i = 0; i <= most; i++) {
        if (!orl_intersect_uncut(geometry, from, direction, max_distance - gone, ret_hit))
            return false;
        if (orl_holes_hit_remains(geometry, ret_hit)) {
            ret_hit->distance += gone;
            return true;
        }
        from = orl_hit_ray_origin(geometry, ret_hit, direction);
        gone = orl_dot(orl_sub(from, origin), direction);
        if (!(gone < max_distance))
            return false;
    }
    return false;
}

bool orl_geometry_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                            struct orl_vec3 direction, double max_distance, struct orl_hit *ret_hit)
{
    return geometry->holes
               ? intersect_remaining(geometry, origin, direction, max_distance, ret_hit)
               : orl_intersect_uncut(geometry, origin, direction, max_distance, ret_hit);
}

void orl_geometry_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                                 size_t n, bool alike, struct orl_hit *ret_hits, bool *ret_found)
{
    struct orl_embree_hit met[AT_ONCE];
    for (size_t i = 0; i < n && geometry->holes; i++)
        ret_found[i] = intersect_remaining(geometry, rays[i].origin, rays[i].direction, INFINITY,
                                           &ret_hits[i]);
    if (geometry->holes)
        return;
    for (size_t first = 0; first < n; first += AT_ONCE) {
        const size_t count = n - first < AT_ONCE ? n - first : AT_ONCE;
        orl_embree_intersect_many(geometry, rays + first, count, alike, met, ret_found + first);
        if (geometry->packed && !geometry->curved && geometry->n_instances == 0)
            orl_hit_prefetch(geometry, met, ret_found + first, count);
        for (size_t i = 0; i < count; i++)
            if (ret_found[first + i])
                orl_hit_refine(geometry, rays[first + i].origin, rays[first + i].direction, &met[i],
                               &ret_hits[first + i]);
    }
}

bool orl_geometry_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                           struct orl_vec3 direction, double max_distance)
{
    struct orl_hit hit;
    return geometry->holes ? intersect_remaining(geometry, origin, direction, max_distance, &hit)
                           : orl_embree_occluded(geometry, origin, direction, max_distance);
}

void orl_hit_uv(const struct orl_geometry *geometry, const struct orl_hit *hit, double ret_uv[2])
{
    struct orl_quadric room;
    if (orl_facet_kind(geometry, hit->facet) != ORL_SURFACE_POLYGON) {
        const struct orl_facet facet = orl_instance_facet(geometry, hit->facet, &room);
        orl_quadric_uv(&facet, hit->point, ret_uv);
        return;
    }
    const struct orl_triangle t = orl_triangle_get(geometry, hit->triangle);
    const struct orl_vec3 ab = orl_sub(t.b, t.a), ac = orl_sub(t.c, t.a);
    const struct orl_vec3 ap = orl_sub(hit->point, t.a), n = orl_cross(ab, ac);
    const double n2 = orl_dot(n, n);
    ret_uv[0] = n2 > 0 ? orl_dot(orl_cross(ap, ac), n) / n2 : 0;
    ret_uv[1] = n2 > 0 ? orl_dot(orl_cross(ab, ap), n) / n2 : 0;
}

static inline double area_of(const struct orl_geometry *geometry, size_t index)
{
    if (geometry->areas)
        return geometry->areas[index];
    const struct orl_triangle t = orl_triangle_get_own(geometry, index);
    return orl_triangle_area(&t);
}

/*
 * Returns a point of a triangle. left: the part of u[0] times the facet's area that falls into this
 * triangle, reused as a random number.
 */
static inline struct orl_vec3 triangle_point(const struct orl_triangle *t, double area, double left,
                                             double v)
{
    const double share = area > 0 && left > 0 ? left / area : 0;
    const double s = sqrt(share < 1 ? share : 1);
    return orl_add(orl_add(orl_scale(t->a, 1 - s), orl_scale(t->b, s * (1 - v))),
                   orl_scale(t->c, s * v));
}

/* The first coordinate chooses the triangle by area. The loop avoids a branch that would be
 * unpredictable. */
static inline struct orl_vec3 polygon_point(const struct orl_geometry *geometry,
                                            const struct orl_facet *f, const double u[2])
{
    double left = u[0] * f->area;
    uint32_t chosen = 0, on = 1;
    for (uint32_t i = 0; i + 1 < f->n_triangles && on; i++) {
        const double area = area_of(geometry, orl_facet_triangle(f, i));
        on = left < area ? 0U : 1U;
        left -= on ? area : 0;
        chosen += on;
    }
    const uint32_t index = orl_facet_triangle(f, chosen);
    const struct orl_triangle t = orl_triangle_get_own(geometry, index);
    return triangle_point(&t, area_of(geometry, index), left, u[1]);
}

/* polygon_point for many points on one or two triangles, which are looked up once. */
static void sample_simple(const struct orl_geometry *geometry, const struct orl_facet *f,
                          const double (*u)[2], size_t n, struct orl_vec3 *ret_points)
{
    struct orl_triangle t[2];
    double area[2];
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        t[i] = orl_triangle_get_own(geometry, orl_facet_triangle(f, i));
        area[i] = area_of(geometry, orl_facet_triangle(f, i));
    }
    for (size_t i = 0; i < n; i++) {
        const double left = u[i][0] * f->area;
        const bool second = f->n_triangles > 1 && !(left < area[0]);
        ret_points[i] =
            triangle_point(&t[second], area[second], second ? left - area[0] : left, u[i][1]);
    }
}

void orl_facet_sample_many(const struct orl_geometry *geometry, uint32_t facet,
                           const double (*u)[2], size_t n, struct orl_vec3 *ret_points)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(geometry, facet, &own);
    struct orl_vec3 normal;
    if (f->kind == ORL_SURFACE_POLYGON && (f->n_triangles == 1 || f->n_triangles == 2))
        sample_simple(geometry, f, u, n, ret_points);
    else if (f->kind == ORL_SURFACE_POLYGON)
        for (size_t i = 0; i < n; i++)
            ret_points[i] = polygon_point(geometry, f, u[i]);
    else
        for (size_t i = 0; i < n; i++)
            orl_quadric_sample(f, u[i], &ret_points[i], &normal);
}

static void sample_own(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                       struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(geometry, facet, &own);
    if (f->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_sample(f, u, ret_point, ret_normal);
        return;
    }
    *ret_point = polygon_point(geometry, f, u);
    *ret_normal = f->normal;
}

void orl_facet_sample(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                      struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    if (!orl_facet_is_instanced(geometry, facet)) {
        sample_own(geometry, facet, u, ret_point, ret_normal);
        return;
    }
    const struct orl_instance *const instance = orl_instance_of(geometry, facet);
    sample_own(instance->prototype, facet - instance->first_facet, u, ret_point, ret_normal);
    *ret_point = orl_xform_point(&instance->to, *ret_point);
    *ret_normal = orl_xform_normal(&instance->to, *ret_normal);
}

/* ---- Offsets from surfaces ------------------------------------------------------------------- */

enum { MOST_SURFACES = 8, TOUCH_RAYS = 64 };

/* Returns the rounding of a ray's origin to floats: some ulps of it, and one of the whole scene. */
static double rounding(const struct orl_geometry *g, struct orl_vec3 point)
{
    return orl_largest(point) * 0x1p-20 + g->radius * 0x1p-24;
}

struct orl_vec3 orl_offset_from_surface(const struct orl_geometry *g, struct orl_vec3 point,
                                        struct orl_vec3 normal)
{
    /* Depth below a surface at which a sensor still counts as lying on it: rtrace -I starts rays as
     * far ahead, and coordinates written with six digits lie that low by rounding. In small scenes
     * it is limited to a small part of the size. */
    const double sunk = fmin(1.1e-4, g->radius * 0x1p-16);
    /* No facet's offset exceeds 2^-20 of the radius, so surfaces further away do not matter. */
    const double span = fmax(orl_geometry_resolution(g), 2 * sunk);
    struct orl_vec3 from = orl_madd(point, normal, span);
    double lift = rounding(g, point);
    for (int i = 0; i < MOST_SURFACES; i++) {
        struct orl_hit hit;
        const double left = orl_dot(orl_sub(from, point), normal) + span;
        if (!(left > 0) || !orl_geometry_intersect(g, from, orl_neg(normal), left, &hit))
            break;
        const double clear = 2 * orl_facet_offset(g, hit.facet);
        const double slope = fmax(0.25, fabs(orl_dot(hit.normal, normal)));
        const double height = orl_dot(orl_sub(hit.point, point), normal);
        if (fabs(height) * slope <= clear || (height > 0 && height * slope <= sunk))
            lift = fmax(lift, height + clear / slope);
        from = orl_hit_ray_origin(g, &hit, orl_neg(normal));
    }
    return orl_madd(point, normal, lift);
}

bool orl_find_surface_contact(const struct orl_geometry *g, struct orl_vec3 point,
                              struct orl_surface_contact *ret_touch)
{
    const double golden_angle = 2.399963229728653;
    bool touches = false;
    for (int i = 0; i < TOUCH_RAYS; i++) {
        const double z = 1 - (2 * i + 1.0) / TOUCH_RAYS, s = sqrt(1 - z * z);
        const struct orl_vec3 way = orl_v3(s * cos(golden_angle * i), s * sin(golden_angle * i), z);
        struct orl_hit hit;
        if (!orl_geometry_intersect(g, point, way, orl_geometry_resolution(g), &hit))
            continue;
        const double height = fabs(orl_dot(orl_sub(hit.point, point), hit.normal));
        if (!touches || height < ret_touch->distance)
            *ret_touch = (struct orl_surface_contact){hit.facet, height};
        touches = true;
    }
    return touches;
}
