#include "photon/surface/footprint.h"

#include "scene/geometry/instances.h"

/*
 * Limits of curved facets: they end where their normal has turned by this angle, because sheets
 * (orl_same_sheet) end at 30 degrees. On spheres a chord is as good as an arc (equal areas); around
 * tubes an arc of 20 degrees is 0.5 % longer than its chord.
 */
static const double sine_14 = 0.2419218956, sine_20 = 0.3420201433;

/* A polygon's corners, and its instance. */
struct corners {
    struct orl_facet_outline outline;
    const struct orl_instance *instance; /* the instance; NULL: not instanced */
};

static struct corners corners_of(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    const struct orl_geometry *const g = lit_scene->geometry;
    if (!orl_facet_is_instanced(g, facet))
        return (struct corners){orl_outline_of_facet(g, facet), NULL};
    const struct orl_instance *const instance = orl_instance_of(g, facet);
    return (struct corners){
        orl_outline_of_facet(instance->prototype, facet - instance->first_facet), instance};
}

static inline __attribute__((always_inline)) struct orl_vec3 corner(const struct corners *corners,
                                                                    uint32_t i)
{
    const struct orl_vec3 at = orl_outline_corner(&corners->outline, i);
    return corners->instance ? orl_xform_point(&corners->instance->to, at) : at;
}

/* Returns the line through a and b in the tangent plane, with its normal away from the origin. */
static struct orl_line line_through(const double a[2], const double b[2])
{
    const double x = b[1] - a[1], y = a[0] - b[0], length = sqrt(x * x + y * y);
    struct orl_line line = {{0, 0}, 0};
    if (!(length > 0))
        return line;
    const double offset = (x * a[0] + y * a[1]) / length, sign = offset < 0 ? -1 : 1;
    line.normal[0] = sign * x / length;
    line.normal[1] = sign * y / length;
    line.offset = sign * offset;
    return line;
}

static double polygon_exit(const struct corners *corners, const struct orl_frame *frame,
                           struct orl_vec3 origin, const double direction[2], double from,
                           struct orl_line *ret_line)
{
    double best = INFINITY, a[2], beside_a = 0;
    for (uint32_t i = 0; i <= corners->outline.n; i++) {
        const uint32_t at = i < corners->outline.n ? i : 0;
        const struct orl_vec3 way = orl_sub(corner(corners, at), origin);
        const double b[2] = {orl_dot(way, frame->u), orl_dot(way, frame->v)};
        const double beside_b = direction[0] * b[1] - direction[1] * b[0];
        if (i > 0 && (beside_a > 0) != (beside_b > 0)) {
            const double share = beside_a / (beside_a - beside_b);
            const double x = a[0] + share * (b[0] - a[0]), y = a[1] + share * (b[1] - a[1]);
            const double length = direction[0] * x + direction[1] * y;
            if (length > from && length < best) {
                best = length;
                *ret_line = line_through(a, b);
            }
        }
        a[0] = b[0];
        a[1] = b[1];
        beside_a = beside_b;
    }
    return best;
}

static double ring_exit(const struct orl_facet *f, const struct orl_frame *frame,
                        struct orl_vec3 origin, const double direction[2], double from)
{
    const struct orl_vec3 way = orl_sub(f->quadric->center[0], origin);
    const double x = orl_dot(way, frame->u), y = orl_dot(way, frame->v);
    const double along = direction[0] * x + direction[1] * y;
    double best = INFINITY;
    for (int i = 0; i < 2; i++) {
        const double root2 =
            along * along - x * x - y * y + f->quadric->radius[i] * f->quadric->radius[i];
        for (int sign = -1; sign <= 1 && root2 >= 0; sign += 2) {
            const double length = along + sign * sqrt(root2);
            if (length > from && length < best)
                best = length;
        }
    }
    return best;
}

/* Cylinders and cones: up to the ends along the axis, and 20 degrees around it. */
static double tube_exit(const struct orl_facet *f, const struct orl_frame *frame,
                        struct orl_vec3 origin, const double direction[2])
{
    const struct orl_vec3 whole = orl_sub(f->quadric->center[1], f->quadric->center[0]);
    const double length = orl_length(whole);
    const struct orl_vec3 axis = orl_scale(whole, 1 / length);
    const struct orl_vec3 way =
        orl_add(orl_scale(frame->u, direction[0]), orl_scale(frame->v, direction[1]));
    const double z = orl_dot(orl_sub(origin, f->quadric->center[0]), axis),
                 climb = orl_dot(way, axis);
    const double around = orl_dot(way, orl_normalize(orl_cross(axis, frame->n)));
    const double radius =
        f->quadric->radius[0] + (f->quadric->radius[1] - f->quadric->radius[0]) * z / length;
    double best = INFINITY;
    if (around != 0)
        best = fabs(radius * sine_20 / around);
    if (fabs(climb) > 1e-9)
        best = orl_smaller(best, orl_larger((climb > 0 ? length - z : -z) / climb, 0));
    return best;
}

double orl_outline_exit(const struct orl_lit_scene *lit_scene, uint32_t facet,
                        const struct orl_frame *frame, struct orl_vec3 origin,
                        const double direction[2], double from, struct orl_line *ret_line)
{
    struct orl_quadric room;
    *ret_line = (struct orl_line){{0, 0}, 0};
    if (orl_facet_kind(lit_scene->geometry, facet) == ORL_SURFACE_POLYGON) {
        const struct corners corners = corners_of(lit_scene, facet);
        return polygon_exit(&corners, frame, origin, direction, from, ret_line);
    }
    const struct orl_facet f = orl_instance_facet(lit_scene->geometry, facet, &room);
    switch (f.kind) {
    case ORL_SURFACE_RING:
        return ring_exit(&f, frame, origin, direction, from);
    case ORL_SURFACE_SPHERE:
    case ORL_SURFACE_BUBBLE:
        return 2 * sine_14 * f.quadric->radius[0];
    default:
        return tube_exit(&f, frame, origin, direction);
    }
}

static double distance2_to_edge(struct orl_vec3 point, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct orl_vec3 edge = orl_sub(b, a), way = orl_sub(point, a);
    const double length2 = orl_dot(edge, edge);
    const double share =
        length2 > 0 ? orl_smaller(orl_larger(orl_dot(way, edge) / length2, 0), 1) : 0;
    const struct orl_vec3 off = orl_madd(way, edge, -share);
    return orl_dot(off, off);
}

static double round_clearance(const struct orl_facet *f, struct orl_vec3 point)
{
    if (f->kind == ORL_SURFACE_SPHERE || f->kind == ORL_SURFACE_BUBBLE)
        return 2 * sine_14 * f->quadric->radius[0];
    if (f->kind != ORL_SURFACE_RING)
        return 0;
    const double at = orl_length(orl_sub(point, f->quadric->center[0]));
    return orl_larger(orl_smaller(f->quadric->radius[1] - at, f->quadric->radius[0] > 0
                                                                  ? at - f->quadric->radius[0]
                                                                  : INFINITY),
                      0);
}

double orl_outline_clearance(const struct orl_lit_scene *lit_scene, uint32_t facet,
                             struct orl_vec3 point)
{
    struct orl_quadric room;
    if (orl_facet_kind(lit_scene->geometry, facet) != ORL_SURFACE_POLYGON) {
        const struct orl_facet f = orl_instance_facet(lit_scene->geometry, facet, &room);
        return round_clearance(&f, point);
    }
    const struct corners corners = corners_of(lit_scene, facet);
    struct orl_vec3 last = corner(&corners, corners.outline.n - 1);
    double best = INFINITY;
    for (uint32_t i = 0; i < corners.outline.n; i++) {
        const struct orl_vec3 next = corner(&corners, i);
        best = orl_smaller(best, distance2_to_edge(point, last, next));
        last = next;
    }
    return sqrt(best);
}
