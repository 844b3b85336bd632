/* What rays meet: Embree's answers on the true surfaces, in double; and places on facets. */
#include "scene/geometry/embree.h"
#include "scene/geometry/quadric.h"

enum { AT_ONCE = 64 }; /* rays */

/* Whether a point of its plane lies on the facet, its rim included: on which triangle. */
static bool holds(const struct orl_geometry *geometry, const struct orl_facet *facet,
                  struct orl_vec3 point, uint32_t *ret_triangle)
{
    const double slack = -facet->offset;
    for (uint32_t i = 0; i < facet->n_triangles; i++) {
        const struct orl_triangle *t = &geometry->triangles[facet->first_triangle + i];
        *ret_triangle = facet->first_triangle + i;
        const struct orl_vec3 corners[4] = {t->a, t->b, t->c, t->a};
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

/* A hit on a back is on the front of a rival that lies there. */
static void choose_front(const struct orl_geometry *geometry, struct orl_hit *hit)
{
    const struct orl_facet *facet = &geometry->facets[hit->facet];
    for (uint32_t i = 0; i < facet->n_rivals; i++) {
        const uint32_t rival = geometry->rivals[facet->first_rival + i];
        uint32_t triangle;
        if (!holds(geometry, &geometry->facets[rival], hit->point, &triangle))
            continue;
        hit->facet = rival;
        hit->triangle = triangle;
        hit->normal = geometry->facets[rival].normal;
        hit->front = true;
        return;
    }
}

/* The plane that a hit lies in: not a bent polygon's mean one, which may be on the far side of the
 * triangle that Embree met. Not a unit normal. */
static struct orl_vec3 plane_of(const struct orl_facet *facet, const struct orl_triangle *t)
{
    return facet->bent ? orl_cross(orl_sub(t->b, t->a), orl_sub(t->c, t->a)) : facet->normal;
}

/* The hit on the true surface, in double. */
static inline void settle_hit(const struct orl_geometry *geometry, struct orl_vec3 origin,
                              struct orl_vec3 direction, const struct orl_embree_hit *e,
                              struct orl_hit *ret_hit)
{
    const uint32_t index = e->curved ? e->index : geometry->triangles[e->index].facet;
    const struct orl_facet *facet = &geometry->facets[index];
    double t = e->distance;
    struct orl_vec3 normal = facet->normal;
    if (e->curved) {
        /* The same root again, in double. At a graze there may be none: then Embree's must do. */
        if (!orl_quadric_intersect(facet, origin, direction, 0.5 * t, 2 * t, &t, &normal))
            normal = orl_quadric_normal(facet, orl_madd(origin, direction, t));
    } else {
        const struct orl_triangle *triangle = &geometry->triangles[e->index];
        const struct orl_vec3 plane = plane_of(facet, triangle);
        const double slope = orl_dot(direction, plane);
        const double exact = orl_dot(orl_sub(triangle->a, origin), plane) / slope;
        if (fabs(exact - t) <= 1e-3 * t + facet->offset)
            t = exact;
    }
    ret_hit->distance = t;
    ret_hit->point = orl_madd(origin, direction, t);
    ret_hit->normal = normal;
    ret_hit->facet = index;
    ret_hit->triangle = e->curved ? 0 : e->index;
    ret_hit->instance = 0;
    ret_hit->front = orl_dot(direction, normal) < 0;
    if (!ret_hit->front && facet->n_rivals > 0)
        choose_front(geometry, ret_hit);
}

bool orl_geometry_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                            struct orl_vec3 direction, double max_distance, struct orl_hit *ret_hit)
{
    struct orl_embree_hit e;
    if (!orl_embree_intersect(geometry, origin, direction, max_distance, &e))
        return false;
    settle_hit(geometry, origin, direction, &e, ret_hit);
    return true;
}

void orl_geometry_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                                 size_t n, bool alike, struct orl_hit *ret_hits, bool *ret_found)
{
    struct orl_embree_hit met[AT_ONCE];
    for (size_t first = 0; first < n; first += AT_ONCE) {
        const size_t count = n - first < AT_ONCE ? n - first : AT_ONCE;
        orl_embree_intersect_many(geometry, rays + first, count, alike, met, ret_found + first);
        for (size_t i = 0; i < count; i++)
            if (ret_found[first + i])
                settle_hit(geometry, rays[first + i].origin, rays[first + i].direction, &met[i],
                           &ret_hits[first + i]);
    }
}

bool orl_geometry_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                           struct orl_vec3 direction, double max_distance)
{
    return orl_embree_occluded(geometry, origin, direction, max_distance);
}

void orl_hit_uv(const struct orl_geometry *geometry, const struct orl_hit *hit, double ret_uv[2])
{
    const struct orl_facet *facet = &geometry->facets[hit->facet];
    if (facet->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_uv(facet, hit->point, ret_uv);
        return;
    }
    const struct orl_triangle *t = &geometry->triangles[hit->triangle];
    const struct orl_vec3 ab = orl_sub(t->b, t->a), ac = orl_sub(t->c, t->a);
    const struct orl_vec3 ap = orl_sub(hit->point, t->a), n = orl_cross(ab, ac);
    const double n2 = orl_dot(n, n);
    ret_uv[0] = n2 > 0 ? orl_dot(orl_cross(ap, ac), n) / n2 : 0;
    ret_uv[1] = n2 > 0 ? orl_dot(orl_cross(ab, ap), n) / n2 : 0;
}

/*
 * A triangle's point; left: what of the first number times the facet's area is the triangle's own,
 * stretched to serve again.
 */
static inline struct orl_vec3 triangle_point(const struct orl_triangle *t, double left, double v)
{
    const double share = t->area > 0 && left > 0 ? left / t->area : 0;
    const double s = sqrt(share < 1 ? share : 1);
    return orl_add(orl_add(orl_scale(t->a, 1 - s), orl_scale(t->b, s * (1 - v))),
                   orl_scale(t->c, s * v));
}

/* The first coordinate picks the triangle by area. Which of two it is, is chance, and no branch. */
static inline struct orl_vec3 polygon_point(const struct orl_geometry *geometry,
                                            const struct orl_facet *f, const double u[2])
{
    const struct orl_triangle *triangles = &geometry->triangles[f->first_triangle];
    double left = u[0] * f->area;
    uint32_t chosen = 0, on = 1;
    for (uint32_t i = 0; i + 1 < f->n_triangles && on; i++) {
        on = left < triangles[i].area ? 0U : 1U;
        left -= on ? triangles[i].area : 0;
        chosen += on;
    }
    return triangle_point(&triangles[chosen], left, u[1]);
}

void orl_facet_sample_many(const struct orl_geometry *geometry, uint32_t facet,
                           const double (*u)[2], size_t n, struct orl_vec3 *ret_points)
{
    const struct orl_facet *f = &geometry->facets[facet];
    struct orl_vec3 normal;
    if (f->kind == ORL_SURFACE_POLYGON)
        for (size_t i = 0; i < n; i++)
            ret_points[i] = polygon_point(geometry, f, u[i]);
    else
        for (size_t i = 0; i < n; i++)
            orl_quadric_sample(f, u[i], &ret_points[i], &normal);
}

void orl_facet_sample(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                      struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const struct orl_facet *f = &geometry->facets[facet];
    if (f->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_sample(f, u, ret_point, ret_normal);
        return;
    }
    *ret_point = polygon_point(geometry, f, u);
    *ret_normal = f->normal;
}
