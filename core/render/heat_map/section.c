#include "render/heat_map/heat_map.h"

#include "scene/geometry/instances.h"

enum { SIDES = 32 };
/* Distance of the cut from the plane, as a share of the scene's radius. */
static const double hair = 1e-6;

struct cut {
    const struct orl_geometry *geometry;
    const struct orl_sensor_plane *plane;
    double offset; /* offset of the cut in moved coordinates */
    orl_section_segment piece;
    void *ctx;
};

/* Returns the intersection of the edge from a to b with the plane; sa and sb: their signed
 * distances from it. */
static void cross_edge(const struct cut *cut, struct orl_vec3 a, struct orl_vec3 b, double sa,
                       double sb, double ret_at[2])
{
    const struct orl_vec3 point =
        orl_add(orl_madd(a, orl_sub(b, a), sa / (sa - sb)), cut->geometry->center);
    ret_at[0] = orl_dot(cut->plane->u, point);
    ret_at[1] = orl_dot(cut->plane->v, point);
}

static void cut_triangle(const struct cut *cut, const struct orl_vec3 corners[3])
{
    double s[3], ends[2][2];
    int n = 0;
    for (int i = 0; i < 3; i++)
        s[i] = orl_dot(cut->plane->normal, corners[i]) - cut->offset;
    for (int i = 0; i < 3; i++) {
        const int next = (i + 1) % 3;
        if ((s[i] >= 0) != (s[next] >= 0))
            cross_edge(cut, corners[i], corners[next], s[i], s[next], ends[n++]);
    }
    if (n == 2)
        cut->piece(cut->ctx, ends[0], ends[1]);
}

static void cut_sphere(const struct cut *cut, const struct orl_facet *facet)
{
    const double off = cut->offset - orl_dot(cut->plane->normal, facet->quadric->center[0]);
    const double square = facet->quadric->radius[0] * facet->quadric->radius[0] - off * off;
    const struct orl_vec3 center = orl_add(facet->quadric->center[0], cut->geometry->center);
    const double u = orl_dot(cut->plane->u, center), v = orl_dot(cut->plane->v, center);
    double before[2] = {u + sqrt(fmax(square, 0)), v};
    for (int i = 1; i <= SIDES && square > 0; i++) {
        const double a = 2 * ORL_PI * i / SIDES, r = sqrt(square);
        const double at[2] = {u + r * cos(a), v + r * sin(a)};
        cut->piece(cut->ctx, before, at);
        before[0] = at[0];
        before[1] = at[1];
    }
}

/* Cuts a round surface as two triangles a side, between circles about the two centres. */
static void cut_round(const struct cut *cut, const struct orl_facet *facet)
{
    const bool ring = facet->kind == ORL_SURFACE_RING;
    const bool even = facet->kind == ORL_SURFACE_CYLINDER || facet->kind == ORL_SURFACE_TUBE;
    const struct orl_vec3 second = ring ? facet->quadric->center[0] : facet->quadric->center[1];
    const double radii[2] = {facet->quadric->radius[0],
                             even ? facet->quadric->radius[0] : facet->quadric->radius[1]};
    const struct orl_vec3 axis =
        ring ? facet->normal
             : orl_normalize(orl_sub(facet->quadric->center[1], facet->quadric->center[0]));
    const struct orl_frame frame = orl_frame_about(axis);
    struct orl_vec3 a = orl_madd(facet->quadric->center[0], frame.u, radii[0]);
    struct orl_vec3 b = orl_madd(second, frame.u, radii[1]);
    for (int i = 1; i <= SIDES; i++) {
        const double t = 2 * ORL_PI * i / SIDES;
        const struct orl_vec3 way = orl_add(orl_scale(frame.u, cos(t)), orl_scale(frame.v, sin(t)));
        const struct orl_vec3 c = orl_madd(facet->quadric->center[0], way, radii[0]);
        const struct orl_vec3 d = orl_madd(second, way, radii[1]);
        cut_triangle(cut, (const struct orl_vec3[3]){a, b, d});
        cut_triangle(cut, (const struct orl_vec3[3]){a, d, c});
        a = c;
        b = d;
    }
}

static void cut_facet(const struct cut *cut, const struct orl_facet *facet)
{
    if (facet->kind == ORL_SURFACE_SPHERE || facet->kind == ORL_SURFACE_BUBBLE)
        cut_sphere(cut, facet);
    else if (facet->kind != ORL_SURFACE_POLYGON)
        cut_round(cut, facet);
}

static void cut_numbered(const struct cut *cut, size_t triangle)
{
    const struct orl_triangle t = orl_triangle_get(cut->geometry, triangle);
    cut_triangle(cut, (const struct orl_vec3[3]){t.a, t.b, t.c});
}

/* Cuts a placed prototype if the plane intersects its bounding box. */
static void cut_instance(const struct cut *cut, const struct orl_instance *instance)
{
    const struct orl_geometry *const prototype = instance->prototype;
    const struct orl_vec3 n = cut->plane->normal, low = instance->low, high = instance->high;
    const double least = fmin(low.x * n.x, high.x * n.x) + fmin(low.y * n.y, high.y * n.y) +
                         fmin(low.z * n.z, high.z * n.z);
    const double most = fmax(low.x * n.x, high.x * n.x) + fmax(low.y * n.y, high.y * n.y) +
                        fmax(low.z * n.z, high.z * n.z);
    if (cut->offset < least || cut->offset > most)
        return;
    for (size_t i = 0; i < orl_geometry_triangles_end(prototype); i++)
        if (!orl_triangle_is_unused(prototype, i))
            cut_numbered(cut, instance->first_triangle + i);
    for (size_t i = 0; i < prototype->n_quadrics; i++) {
        struct orl_quadric room;
        const size_t own = prototype->n_facets - 1 - i;
        const struct orl_facet facet =
            orl_instance_facet(cut->geometry, instance->first_facet + (uint32_t)own, &room);
        cut_facet(cut, &facet);
    }
}

void orl_section_cut(const struct orl_geometry *geometry, const struct orl_sensor_plane *plane,
                     orl_section_segment piece, void *ctx)
{
    const struct cut cut = {geometry, plane,
                            plane->offset - orl_dot(plane->normal, geometry->center) +
                                hair * geometry->radius,
                            piece, ctx};
    for (size_t i = 0; i < orl_geometry_triangles_end(geometry); i++)
        if (!orl_triangle_is_unused(geometry, i))
            cut_numbered(&cut, i);
    for (size_t i = 0; i < geometry->n_facets; i++) {
        struct orl_facet own;
        cut_facet(&cut, orl_facet_get_own(geometry, i, &own));
    }
    for (size_t i = 0; i < geometry->n_instances; i++)
        cut_instance(&cut, &geometry->instance[i]);
}
