#include "scene/geometry/geometry.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/crew.h>
#include <oriel/limits.h>

#include "scene/geometry/embree.h"
#include "scene/geometry/quadric.h"
#include "scene/geometry/triangulate.h"

enum { AT_ONCE = 64 }; /* rays */

static void include(struct orl_vec3 p, struct orl_vec3 *low, struct orl_vec3 *high)
{
    *low = orl_v3(fmin(low->x, p.x), fmin(low->y, p.y), fmin(low->z, p.z));
    *high = orl_v3(fmax(high->x, p.x), fmax(high->y, p.y), fmax(high->z, p.z));
}

static double largest(struct orl_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

static void fill_curved(struct orl_facet *facet, const struct orl_surface *surface)
{
    facet->normal = surface->normal;
    for (int k = 0; k < 2; k++) {
        facet->center[k] = surface->center[k];
        facet->radius[k] = surface->radius[k];
    }
    if (surface->kind == ORL_SURFACE_CYLINDER || surface->kind == ORL_SURFACE_TUBE)
        facet->radius[1] = facet->radius[0];
}

static void bounds_of(const struct orl_surface *surface, struct orl_vec3 *low,
                      struct orl_vec3 *high)
{
    struct orl_facet facet = {.kind = surface->kind};
    struct orl_vec3 a, b;
    for (uint32_t i = 0; i < surface->n_vertices; i++)
        include(surface->vertices[i], low, high);
    if (surface->kind != ORL_SURFACE_POLYGON) {
        fill_curved(&facet, surface);
        orl_quadric_bounds(&facet, &a, &b);
        include(a, low, high);
        include(b, low, high);
    }
}

/* What building needs besides: room for triangles, and scratch. */
struct builder {
    struct orl_geometry *g;
    const struct orl_description *description;
    struct orl_triangulation triangulation;
    size_t triangles_room;
    struct orl_error *err;
};

static bool make_room(struct builder *b, size_t more)
{
    const size_t wanted = b->g->n_triangles + more;
    if (wanted < b->triangles_room)
        return true;
    const size_t room = wanted + wanted / 2 + 1;
    struct orl_triangle *grown = realloc(b->g->triangles, room * sizeof *grown);
    if (!grown)
        return false;
    b->g->triangles = grown;
    b->triangles_room = room;
    return true;
}

static int refuse_outline(const struct builder *b, const struct orl_surface *surface, int code)
{
    char name[ORL_ERROR_NAME_MAX];
    if (code == ORL_ERR_NOMEM)
        return code;
    snprintf(name, sizeof name, "polygon %.200s", surface->name);
    if (code == ORL_ERR_LIMIT)
        orl_error_set(
            b->err, code,
            "its outline crosses itself more than %u times, or in too many places at once",
            ORL_LIMIT_POLYGON_CROSSINGS);
    else
        orl_error_set(b->err, code, "its outline could not be cut into triangles");
    orl_error_at(b->err, surface->file, surface->line, name);
    return code;
}

/* Cuts a polygon into triangles, moved, and measures it. */
static int add_polygon(struct builder *b, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_geometry *g = b->g;
    struct orl_facet *f = &g->facets[facet];
    const struct orl_triangulation *cut = &b->triangulation;
    double reach = 0, bend = 0;
    const int code =
        orl_triangulate(&b->triangulation, surface->vertices, surface->n_vertices, surface->normal);
    if (code < 0)
        return refuse_outline(b, surface, code);
    if (!make_room(b, cut->n_triples))
        return ORL_ERR_NOMEM;
    f->normal = surface->normal;
    f->first_triangle = (uint32_t)g->n_triangles;
    f->n_triangles = (uint32_t)cut->n_triples;
    for (size_t i = 0; i < cut->n_triples; i++) {
        const uint32_t *triple = cut->triples[i];
        struct orl_triangle t = {orl_sub(cut->corners[triple[0]], g->center),
                                 orl_sub(cut->corners[triple[1]], g->center),
                                 orl_sub(cut->corners[triple[2]], g->center), facet, 0};
        t.area = 0.5 * orl_length(orl_cross(orl_sub(t.b, t.a), orl_sub(t.c, t.a)));
        g->triangles[g->n_triangles++] = t;
        f->area += t.area;
        reach = fmax(reach, fmax(largest(t.a), fmax(largest(t.b), largest(t.c))));
        bend = fmax(bend, fmax(fabs(orl_dot(orl_sub(t.b, t.a), f->normal)),
                               fabs(orl_dot(orl_sub(t.c, t.a), f->normal))));
    }
    f->offset = reach * 0x1p-20;
    f->bent = bend > reach * 0x1p-23;
    return 0;
}

static void add_curved(struct orl_geometry *g, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_facet *f = &g->facets[facet];
    struct orl_vec3 low, high;
    fill_curved(f, surface);
    for (int k = 0; k < 2; k++)
        f->center[k] = orl_sub(f->center[k], g->center);
    orl_quadric_bounds(f, &low, &high);
    f->area = orl_quadric_area(f);
    f->offset = fmax(largest(low), largest(high)) * 0x1p-20;
}

/* Polygons come first and curved facets last, so that Embree's numbers map by arithmetic alone. */
static int add_facets(struct builder *b)
{
    struct orl_geometry *g = b->g;
    const struct orl_description *d = b->description;
    size_t polygon = 0, curved = d->n_surfaces;
    int code = 0;
    for (size_t i = 0; i < d->n_surfaces && code == 0; i++) {
        const struct orl_surface *surface = &d->surfaces[i];
        const bool flat = surface->kind == ORL_SURFACE_POLYGON;
        const uint32_t facet = (uint32_t)(flat ? polygon++ : --curved);
        g->facets[facet].kind = surface->kind;
        g->facets[facet].material = surface->material;
        g->facets[facet].surface = (uint32_t)i;
        g->facets[facet].beyond = d->materials[surface->material].thickness;
        if (flat)
            code = add_polygon(b, surface, facet);
        else
            add_curved(g, surface, facet);
        if (orl_is_cancelled(d->cancel))
            code = ORL_ERR_CANCELLED;
    }
    return code;
}

/* The lists of rivals, by facet. */
static int add_rivals(struct orl_geometry *g, const struct orl_description *d)
{
    uint32_t *facets = NULL;
    if (d->n_opposed == 0)
        return 0;
    facets = malloc(d->n_surfaces * sizeof *facets);
    g->rivals = malloc(2 * d->n_opposed * sizeof *g->rivals);
    if (!facets || !g->rivals) {
        free(facets);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < g->n_facets; i++)
        facets[g->facets[i].surface] = (uint32_t)i;
    for (size_t i = 0; i < 2 * d->n_opposed; i++)
        g->facets[facets[d->opposed[i / 2].surfaces[i % 2]]].n_rivals++;
    for (size_t i = 0; i < g->n_facets; i++) {
        g->facets[i].first_rival = (uint32_t)g->n_rivals;
        g->n_rivals += g->facets[i].n_rivals;
        g->facets[i].n_rivals = 0;
    }
    for (size_t i = 0; i < 2 * d->n_opposed; i++) {
        struct orl_facet *f = &g->facets[facets[d->opposed[i / 2].surfaces[i % 2]]];
        g->rivals[f->first_rival + f->n_rivals++] = facets[d->opposed[i / 2].surfaces[1 - i % 2]];
    }
    free(facets);
    return 0;
}

static void measure(struct orl_geometry *g, const struct orl_description *d)
{
    struct orl_vec3 low = orl_v3(INFINITY, INFINITY, INFINITY), high = orl_neg(low);
    for (size_t i = 0; i < d->n_surfaces; i++)
        bounds_of(&d->surfaces[i], &low, &high);
    if (d->n_surfaces == 0)
        low = high = orl_v3(0, 0, 0);
    g->center = orl_scale(orl_add(low, high), 0.5);
    g->low = orl_sub(low, g->center);
    g->high = orl_sub(high, g->center);
    g->radius = orl_length(g->high);
}

int orl_geometry_prepare_thread(struct orl_error *err)
{
    return orl_embree_prepare(err);
}

int orl_geometry_new(const struct orl_description *description, struct orl_geometry **ret_geometry,
                     struct orl_error *err)
{
    int code = ORL_ERR_NOMEM;
    struct orl_geometry *g = calloc(1, sizeof *g);
    struct builder builder = {.g = g, .description = description, .err = err};
    if (!g)
        goto done;
    if (description->n_surfaces > ORL_LIMIT_SURFACES) {
        code = orl_error_set(err, ORL_ERR_LIMIT, "%zu surfaces; at most %lu are allowed",
                             description->n_surfaces, ORL_LIMIT_SURFACES);
        goto done;
    }
    measure(g, description);
    g->n_facets = description->n_surfaces;
    g->facets = calloc(g->n_facets + 1, sizeof *g->facets);
    if (!g->facets || !make_room(&builder, description->n_surfaces))
        goto done;
    code = add_facets(&builder);
    if (code == 0)
        code = add_rivals(g, description);
    if (code == 0)
        code = orl_embree_build(g, description->cancel, err);
done:
    orl_triangulation_done(&builder.triangulation);
    if (code == 0)
        *ret_geometry = g;
    else
        orl_geometry_free(g);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene's geometry");
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while building the scene's geometry");
    return code;
}

int orl_geometry_subset(const struct orl_geometry *whole, const bool *keep,
                        struct orl_geometry **ret_geometry, struct orl_error *err)
{
    struct orl_geometry *g = malloc(sizeof *g);
    int code = ORL_ERR_NOMEM;
    if (!g)
        return orl_error_set(err, code, "out of memory for the scene's geometry");
    *g = *whole;
    g->scene = NULL;
    g->n_triangles = 0;
    g->rivals = malloc((g->n_rivals + 1) * sizeof *g->rivals);
    g->facets = malloc((g->n_facets + 1) * sizeof *g->facets);
    g->triangles = malloc((whole->n_triangles + 1) * sizeof *g->triangles);
    if (!g->facets || !g->triangles || !g->rivals)
        goto done;
    if (g->n_rivals > 0)
        memcpy(g->rivals, whole->rivals, g->n_rivals * sizeof *g->rivals);
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet *f = &g->facets[i];
        const size_t kept = keep[i] ? whole->facets[i].n_triangles : 0;
        *f = whole->facets[i];
        f->area = keep[i] ? f->area : 0;
        f->n_triangles = (uint32_t)kept;
        f->first_triangle = (uint32_t)g->n_triangles;
        memcpy(g->triangles + g->n_triangles, whole->triangles + whole->facets[i].first_triangle,
               kept * sizeof *g->triangles);
        g->n_triangles += kept;
    }
    code = orl_embree_build(g, NULL, err);
done:
    if (code == 0)
        *ret_geometry = g;
    else
        orl_geometry_free(g);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene's geometry");
    return code;
}

void orl_geometry_free(struct orl_geometry *geometry)
{
    if (!geometry)
        return;
    orl_embree_free(geometry);
    free(geometry->facets);
    free(geometry->triangles);
    free(geometry->rivals);
    free(geometry);
}

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

void orl_facet_sample(const struct orl_geometry *geometry, uint32_t facet, const double u[2],
                      struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const struct orl_facet *f = &geometry->facets[facet];
    if (f->kind != ORL_SURFACE_POLYGON) {
        orl_quadric_sample(f, u, ret_point, ret_normal);
        return;
    }
    /* The first coordinate picks the triangle by area and is stretched to serve again. */
    double left = u[0] * f->area;
    const struct orl_triangle *t = &geometry->triangles[f->first_triangle];
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        t = &geometry->triangles[f->first_triangle + i];
        if (left < t->area || i + 1 == f->n_triangles)
            break;
        left -= t->area;
    }
    const double share = t->area > 0 && left > 0 ? left / t->area : 0;
    const double s = sqrt(share < 1 ? share : 1);
    *ret_point = orl_add(orl_add(orl_scale(t->a, 1 - s), orl_scale(t->b, s * (1 - u[1]))),
                         orl_scale(t->c, s * u[1]));
    *ret_normal = f->normal;
}
