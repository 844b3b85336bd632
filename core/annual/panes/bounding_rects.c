#include "annual/panes/bounding_rects.h"

static void widen_to_corner(struct orl_bounding_rect *w, struct orl_vec3 corner)
{
    const struct orl_vec3 from = orl_sub(corner, w->corner);
    for (int i = 0; i < 2; i++) {
        w->low[i] = fmin(w->low[i], orl_dot(from, w->along[i]));
        w->high[i] = fmax(w->high[i], orl_dot(from, w->along[i]));
    }
}

/* The rectangle is aligned with a side of the polygon's first triangle. */
static struct orl_bounding_rect of_polygon(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    const struct orl_triangle t = orl_triangle_get(g, f->first_triangle);
    const struct orl_vec3 sides[3] = {orl_sub(t.b, t.a), orl_sub(t.c, t.b), orl_sub(t.a, t.c)};
    struct orl_bounding_rect w = {.facet = facet, .corner = t.a, .normal = f->normal};
    /* The side of middle length: the longer leg of a right triangle, never its hypotenuse. */
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (orl_length(sides[order[k]]) > orl_length(sides[order[k + 1]])) {
                const int other = order[k];
                order[k] = order[k + 1];
                order[k + 1] = other;
            }
    w.along[0] = orl_normalize(sides[order[1]]);
    w.along[1] = orl_cross(w.normal, w.along[0]);
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle part = orl_triangle_get(g, orl_facet_triangle(f, i));
        widen_to_corner(&w, part.a);
        widen_to_corner(&w, part.b);
        widen_to_corner(&w, part.c);
    }
    return w;
}

static struct orl_bounding_rect of_ring(const struct orl_facet *f, uint32_t facet)
{
    const struct orl_frame frame = orl_frame_about(f->normal);
    const double r = fmax(f->quadric->radius[0], f->quadric->radius[1]);
    return (struct orl_bounding_rect){.facet = facet,
                                      .corner = f->quadric->center[0],
                                      .normal = f->normal,
                                      .along = {frame.u, frame.v},
                                      .low = {-r, -r},
                                      .high = {r, r}};
}

struct orl_bounding_rect orl_bounding_rect_of(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    struct orl_bounding_rect w =
        f->kind == ORL_SURFACE_POLYGON ? of_polygon(g, facet) : of_ring(f, facet);
    const double margin = 4 * f->offset + g->radius * 0x1p-18;
    for (int i = 0; i < 2; i++) {
        w.low[i] -= margin;
        w.high[i] += margin;
    }
    return w;
}

void orl_bounding_rect_widen(struct orl_bounding_rect *window,
                             const struct orl_bounding_rect *other)
{
    for (int i = 0; i < 4; i++)
        widen_to_corner(window, orl_bounding_rect_corner(other, i));
}

bool orl_bounding_rect_passed(const struct orl_bounding_rect *w, struct orl_vec3 origin,
                              struct orl_vec3 direction, double slack, double *ret_distance)
{
    const struct orl_vec3 from = orl_sub(origin, w->corner);
    const double height = orl_dot(from, w->normal), fall = -orl_dot(direction, w->normal);
    /* The ray points away from the plane, or runs along it, even within the slack. */
    if (!(height * fall > 0))
        return false;
    const double distance = height / fall, room = slack * distance / fmax(fabs(fall), 1e-3);
    for (int i = 0; i < 2; i++) {
        const double at = orl_dot(from, w->along[i]) + distance * orl_dot(direction, w->along[i]);
        if (at < w->low[i] - room || at > w->high[i] + room)
            return false;
    }
    if (ret_distance)
        *ret_distance = distance;
    return true;
}

/* Cone of a distant window: around the sphere whose diameter is the rectangle's diagonal. */
static bool find_far_cone(const struct orl_bounding_rect *w, struct orl_vec3 point,
                          struct orl_cone *ret_cone)
{
    const struct orl_vec3 center =
        orl_madd(orl_madd(w->corner, w->along[0], 0.5 * (w->low[0] + w->high[0])), w->along[1],
                 0.5 * (w->low[1] + w->high[1]));
    const double a = w->high[0] - w->low[0], b = w->high[1] - w->low[1];
    const double square = 0.25 * (a * a + b * b);
    const struct orl_vec3 way = orl_sub(center, point);
    const double far = orl_dot(way, way);
    if (!(far > 16 * square))
        return false;
    *ret_cone = (struct orl_cone){orl_scale(way, 1 / sqrt(far)), sqrt(1 - square / far)};
    return true;
}

struct orl_cone orl_bounding_rect_cone(const struct orl_bounding_rect *window,
                                       struct orl_vec3 point)
{
    struct orl_vec3 corners[4], axis = {0, 0, 0};
    struct orl_cone cone = {{0, 0, 1}, -1};
    double least = 1;
    if (find_far_cone(window, point, &cone))
        return cone;
    for (int i = 0; i < 4; i++) {
        corners[i] = orl_normalize(orl_sub(orl_bounding_rect_corner(window, i), point));
        axis = orl_add(axis, corners[i]);
    }
    const double length = orl_length(axis);
    if (!(length > 1e-6)) /* the window surrounds the point */
        return cone;
    axis = orl_scale(axis, 1 / length);
    for (int i = 0; i < 4; i++)
        least = fmin(least, orl_dot(axis, corners[i]));
    /* A cone around the corners contains the window if it is narrower than a half space. */
    return (struct orl_cone){axis, least > 1e-3 ? fmin(least, 1) : -1};
}
