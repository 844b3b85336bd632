#include "scene/geometry/intersect.h"

static bool is_inverted(enum orl_surface_kind kind)
{
    return kind == ORL_SURFACE_BUBBLE || kind == ORL_SURFACE_TUBE || kind == ORL_SURFACE_CUP;
}

static bool is_sphere(enum orl_surface_kind kind)
{
    return kind == ORL_SURFACE_SPHERE || kind == ORL_SURFACE_BUBBLE;
}

/* The axis, its length, and the slope of the radius along it: cylinders are cones of equal
 * radii. */
struct axis {
    struct orl_vec3 direction;
    double length, slope, radius;
};

static struct axis axis_of(const struct orl_facet *facet)
{
    const struct orl_vec3 d = orl_sub(facet->quadric->center[1], facet->quadric->center[0]);
    const double length = orl_length(d);
    return (struct axis){orl_scale(d, 1.0 / length), length,
                         (facet->quadric->radius[1] - facet->quadric->radius[0]) / length,
                         facet->quadric->radius[0]};
}

/* Finds the real roots of a t^2 + 2 h t + c, ascending, without cancellation; returns their
 * number. */
static int solve_quadratic(double a, double h, double c, double roots[2])
{
    const double discriminant = h * h - a * c;
    if (discriminant < 0 || (a == 0 && h == 0))
        return 0;
    const double q = -(h + copysign(sqrt(discriminant), h));
    if (a == 0) {
        roots[0] = c / q;
        return 1;
    }
    const double r0 = q / a, r1 = q != 0 ? c / q : r0;
    roots[0] = fmin(r0, r1);
    roots[1] = fmax(r0, r1);
    return 2;
}

static bool sphere_hit(const struct orl_facet *f, struct orl_vec3 o, struct orl_vec3 d, double near,
                       double far, double *ret_t, struct orl_vec3 *ret_normal)
{
    double roots[2];
    const struct orl_vec3 m = orl_sub(o, f->quadric->center[0]);
    /* Uses the point of the line nearest to the centre, which is exact also far away. */
    const double h = orl_dot(m, d);
    const struct orl_vec3 nearest = orl_madd(m, d, -h);
    const double c =
        orl_dot(nearest, nearest) + h * h - f->quadric->radius[0] * f->quadric->radius[0];
    const int n = solve_quadratic(1.0, h, c, roots);
    for (int i = 0; i < n; i++) {
        if (roots[i] > near && roots[i] < far) {
            *ret_t = roots[i];
            *ret_normal = orl_normalize(orl_madd(m, d, roots[i]));
            return true;
        }
    }
    return false;
}

static bool cone_hit(const struct orl_facet *f, struct orl_vec3 o, struct orl_vec3 d, double near,
                     double far, double *ret_t, struct orl_vec3 *ret_normal)
{
    const struct axis axis = axis_of(f);
    const struct orl_vec3 m = orl_sub(o, f->quadric->center[0]);
    const double mz = orl_dot(m, axis.direction), dz = orl_dot(d, axis.direction);
    const struct orl_vec3 mp = orl_madd(m, axis.direction, -mz),
                          dp = orl_madd(d, axis.direction, -dz);
    const double r0 = axis.radius + axis.slope * mz, r1 = axis.slope * dz;
    double roots[2];
    const int n = solve_quadratic(orl_dot(dp, dp) - r1 * r1, orl_dot(mp, dp) - r0 * r1,
                                  orl_dot(mp, mp) - r0 * r0, roots);
    for (int i = 0; i < n; i++) {
        const double t = roots[i], z = mz + t * dz;
        if (t > near && t < far && z >= 0 && z <= axis.length && r0 + t * r1 >= 0) {
            const struct orl_vec3 radial = orl_normalize(orl_madd(mp, dp, t));
            *ret_t = t;
            *ret_normal = orl_normalize(orl_madd(radial, axis.direction, -axis.slope));
            return true;
        }
    }
    return false;
}

static bool ring_hit(const struct orl_facet *f, struct orl_vec3 o, struct orl_vec3 d, double near,
                     double far, double *ret_t, struct orl_vec3 *ret_normal)
{
    const double slope = orl_dot(d, f->normal);
    if (slope == 0)
        return false;
    const double t = orl_dot(orl_sub(f->quadric->center[0], o), f->normal) / slope;
    const struct orl_vec3 p = orl_sub(orl_madd(o, d, t), f->quadric->center[0]);
    const double r2 = orl_dot(p, p);
    if (!(t > near && t < far) || r2 < f->quadric->radius[0] * f->quadric->radius[0] ||
        r2 > f->quadric->radius[1] * f->quadric->radius[1])
        return false;
    *ret_t = t;
    *ret_normal = f->normal;
    return true;
}

bool orl_quadric_intersect(const struct orl_facet *facet, struct orl_vec3 origin,
                           struct orl_vec3 direction, double near, double far, double *ret_t,
                           struct orl_vec3 *ret_normal)
{
    if (facet->kind == ORL_SURFACE_RING)
        return ring_hit(facet, origin, direction, near, far, ret_t, ret_normal);
    const bool hit = is_sphere(facet->kind)
                         ? sphere_hit(facet, origin, direction, near, far, ret_t, ret_normal)
                         : cone_hit(facet, origin, direction, near, far, ret_t, ret_normal);
    if (hit && is_inverted(facet->kind))
        *ret_normal = orl_neg(*ret_normal);
    return hit;
}

struct orl_vec3 orl_quadric_normal(const struct orl_facet *facet, struct orl_vec3 point)
{
    struct orl_vec3 normal = facet->normal;
    if (is_sphere(facet->kind)) {
        normal = orl_normalize(orl_sub(point, facet->quadric->center[0]));
    } else if (facet->kind != ORL_SURFACE_RING) {
        const struct axis axis = axis_of(facet);
        const struct orl_vec3 m = orl_sub(point, facet->quadric->center[0]);
        const struct orl_vec3 radial =
            orl_normalize(orl_madd(m, axis.direction, -orl_dot(m, axis.direction)));
        normal = orl_normalize(orl_madd(radial, axis.direction, -axis.slope));
    }
    return is_inverted(facet->kind) ? orl_neg(normal) : normal;
}

/* Half extent of a disc of radius r about axis n along each coordinate axis. */
static struct orl_vec3 disc_extent(struct orl_vec3 n, double r)
{
    return orl_v3(r * sqrt(fmax(0, 1 - n.x * n.x)), r * sqrt(fmax(0, 1 - n.y * n.y)),
                  r * sqrt(fmax(0, 1 - n.z * n.z)));
}

static void grow_box(struct orl_vec3 c, struct orl_vec3 e, struct orl_vec3 *low,
                     struct orl_vec3 *high)
{
    orl_box_include(orl_sub(c, e), low, high);
    orl_box_include(orl_add(c, e), low, high);
}

void orl_quadric_bounds(const struct orl_facet *facet, struct orl_vec3 *ret_low,
                        struct orl_vec3 *ret_high)
{
    *ret_low = orl_v3(INFINITY, INFINITY, INFINITY);
    *ret_high = orl_neg(*ret_low);
    if (is_sphere(facet->kind)) {
        const double r = facet->quadric->radius[0];
        grow_box(facet->quadric->center[0], orl_v3(r, r, r), ret_low, ret_high);
    } else if (facet->kind == ORL_SURFACE_RING) {
        grow_box(facet->quadric->center[0], disc_extent(facet->normal, facet->quadric->radius[1]),
                 ret_low, ret_high);
    } else {
        const struct axis axis = axis_of(facet);
        for (int i = 0; i < 2; i++)
            grow_box(facet->quadric->center[i],
                     disc_extent(axis.direction, facet->quadric->radius[i]), ret_low, ret_high);
    }
}

double orl_quadric_area(const struct orl_facet *facet)
{
    const double r0 = facet->quadric->radius[0], r1 = facet->quadric->radius[1];
    if (is_sphere(facet->kind))
        return 4 * ORL_PI * r0 * r0;
    if (facet->kind == ORL_SURFACE_RING)
        return ORL_PI * (r1 * r1 - r0 * r0);
    return ORL_PI * (r0 + r1) * hypot(axis_of(facet).length, r1 - r0);
}

void orl_quadric_sample(const struct orl_facet *facet, const double u[2],
                        struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const double r0 = facet->quadric->radius[0], r1 = facet->quadric->radius[1],
                 phi = 2 * ORL_PI * u[1];
    if (is_sphere(facet->kind)) {
        const double z = 1 - 2 * u[0], s = sqrt(fmax(0, 1 - z * z));
        *ret_normal = orl_v3(s * cos(phi), s * sin(phi), z);
        *ret_point = orl_madd(facet->quadric->center[0], *ret_normal, r0);
    } else if (facet->kind == ORL_SURFACE_RING) {
        const struct orl_frame frame = orl_frame_about(facet->normal);
        const double r = sqrt(r0 * r0 + u[0] * (r1 * r1 - r0 * r0));
        *ret_normal = facet->normal;
        *ret_point = orl_madd(orl_madd(facet->quadric->center[0], frame.u, r * cos(phi)), frame.v,
                              r * sin(phi));
    } else {
        /* Area grows linearly with the radius: invert its integral along the axis. */
        const struct axis axis = axis_of(facet);
        const struct orl_frame frame = orl_frame_about(axis.direction);
        const double r = sqrt(r0 * r0 + u[0] * (r1 * r1 - r0 * r0));
        const double share = fabs(r1 - r0) > 1e-12 * (r0 + r1) ? (r - r0) / (r1 - r0) : u[0];
        const struct orl_vec3 radial =
            orl_add(orl_scale(frame.u, cos(phi)), orl_scale(frame.v, sin(phi)));
        *ret_normal = orl_normalize(orl_madd(radial, axis.direction, -axis.slope));
        *ret_point =
            orl_madd(orl_madd(facet->quadric->center[0], axis.direction, share * axis.length),
                     radial, r0 + share * (r1 - r0));
    }
    if (is_inverted(facet->kind))
        *ret_normal = orl_neg(*ret_normal);
}

/* Angle about the frame's normal, from 0 to 1. */
static double angle_about(const struct orl_frame *frame, struct orl_vec3 way)
{
    const double t = atan2(orl_dot(way, frame->v), orl_dot(way, frame->u)) / (2 * ORL_PI);
    return t < 0 ? t + 1 : t;
}

void orl_quadric_uv(const struct orl_facet *facet, struct orl_vec3 point, double ret_uv[2])
{
    const struct orl_vec3 way = orl_sub(point, facet->quadric->center[0]);
    const bool sphere = is_sphere(facet->kind), ring = facet->kind == ORL_SURFACE_RING;
    const struct axis axis = sphere || ring ? (struct axis){.length = 1} : axis_of(facet);
    const struct orl_frame frame = orl_frame_about(sphere ? orl_v3(0, 0, 1)
                                                   : ring ? facet->normal
                                                          : axis.direction);
    const double along = orl_dot(way, frame.n);
    ret_uv[0] = angle_about(&frame, way);
    if (sphere)
        ret_uv[1] = 0.5 + 0.5 * along / facet->quadric->radius[0];
    else if (ring)
        ret_uv[1] = (orl_length(orl_madd(way, frame.n, -along)) - facet->quadric->radius[0]) /
                    (facet->quadric->radius[1] - facet->quadric->radius[0]);
    else
        ret_uv[1] = along / axis.length;
    ret_uv[1] = fmin(fmax(ret_uv[1], 0), 1);
}
