#include "photon/surface/footprint_side.h"

enum { SECTORS = ORL_FOOTPRINT_SECTORS };

static bool has_border(const struct orl_wedge *wedge)
{
    return wedge->border.normal[0] != 0 || wedge->border.normal[1] != 0;
}

/* A spot in coordinates of the tangent plane. */
struct projected_cluster {
    const struct orl_photon_cluster *cluster;
    const struct orl_frame *frame;
    double x, y, distance;
};

/* Computes bounds on the signed distance of a spot's points to a line, from the spot's disc and
 * its box. */
static void over_line(const struct projected_cluster *projected_cluster,
                      const struct orl_line *line, double *ret_least, double *ret_most)
{
    const struct orl_photon_cluster *p = projected_cluster->cluster;
    const struct orl_frame *f = projected_cluster->frame;
    const double *n = line->normal;
    const double over = n[0] * projected_cluster->x + n[1] * projected_cluster->y,
                 x = n[0] * f->u.x + n[1] * f->v.x, y = n[0] * f->u.y + n[1] * f->v.y,
                 z = n[0] * f->u.z + n[1] * f->v.z;
    const double most = x * (x > 0 ? p->high.x : p->low.x) + y * (y > 0 ? p->high.y : p->low.y) +
                        z * (z > 0 ? p->high.z : p->low.z);
    const double least = x * (x > 0 ? p->low.x : p->high.x) + y * (y > 0 ? p->low.y : p->high.y) +
                         z * (z > 0 ? p->low.z : p->high.z);
    *ret_least = orl_larger(over - p->reach, least) - line->offset;
    *ret_most = orl_smaller(over + p->reach, most) - line->offset;
}

static enum orl_side side_of(const struct projected_cluster *projected_cluster,
                             const struct orl_wedge *wedge)
{
    const double reach = projected_cluster->cluster->reach,
                 rounding = projected_cluster->cluster->rounding;
    double least = -INFINITY, most = -INFINITY;
    if (has_border(wedge))
        over_line(projected_cluster, &wedge->border, &least, &most);
    if (projected_cluster->distance - reach >= wedge->radius || least > rounding)
        return ORL_SIDE_OUTSIDE;
    return projected_cluster->distance + reach <= wedge->radius && most <= rounding
               ? ORL_SIDE_INSIDE
               : ORL_SIDE_BOTH;
}

enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_photon_cluster *cluster)
{
    static const double width = 2 * ORL_PI / SECTORS;
    const double x = orl_dot(cluster->middle, footprint->frame.u);
    const double y = orl_dot(cluster->middle, footprint->frame.v);
    const struct projected_cluster projected_cluster = {cluster, &footprint->frame, x, y,
                                                        sqrt(x * x + y * y)};
    int first = 0, count = SECTORS;
    if (projected_cluster.distance > 2 * cluster->reach) {
        /* An arc sine is less than 1.05 times its sine, for sines up to a half. */
        const double at = atan2(y, x), half = 1.05 * cluster->reach / projected_cluster.distance;
        first = (int)floor((at - half) / width);
        count = (int)floor((at + half) / width) - first + 1;
    }
    const enum orl_side side =
        side_of(&projected_cluster, &footprint->wedges[(unsigned)first % SECTORS]);
    for (int i = 1; i < count && side != ORL_SIDE_BOTH; i++)
        if (side_of(&projected_cluster, &footprint->wedges[(unsigned)(first + i) % SECTORS]) !=
            side)
            return ORL_SIDE_BOTH;
    return side;
}

/* Returns the radius within which no sector ends. */
static double inner_radius(const struct orl_footprint *footprint)
{
    double inner = INFINITY;
    for (int i = 0; i < SECTORS; i++) {
        const struct orl_wedge *wedge = &footprint->wedges[i];
        inner =
            orl_smaller(inner, has_border(wedge) ? orl_smaller(wedge->radius, wedge->border.offset)
                                                 : wedge->radius);
    }
    return inner;
}

/* Returns true if the line is in the list already; the nearer one of the two then remains. */
static bool has_line(struct orl_convex_bound *bound, struct orl_vec3 normal, double offset)
{
    for (uint32_t i = 0; i < bound->n_lines; i++) {
        if (!(orl_dot(normal, bound->normals[i]) > 1 - 1e-12) ||
            !(fabs(offset - bound->offsets[i]) <= 1e-6 * bound->radius))
            continue;
        bound->offsets[i] = orl_smaller(bound->offsets[i], offset);
        return true;
    }
    return false;
}

struct orl_convex_bound orl_footprint_bound(const struct orl_footprint *footprint)
{
    const struct orl_frame *frame = &footprint->frame;
    struct orl_convex_bound bound = {.radius = INFINITY};
    for (int i = 0; i < SECTORS; i++)
        bound.radius = orl_smaller(bound.radius, footprint->wedges[i].radius);
    for (int i = 0; i < SECTORS; i++) {
        const struct orl_line *line = &footprint->wedges[i].border;
        const struct orl_vec3 normal =
            orl_add(orl_scale(frame->u, line->normal[0]), orl_scale(frame->v, line->normal[1]));
        if (!has_border(&footprint->wedges[i]) || has_line(&bound, normal, line->offset))
            continue;
        if (bound.n_lines == ORL_BOUND_LINES)
            return (struct orl_convex_bound){.radius = inner_radius(footprint)};
        bound.normals[bound.n_lines] = normal;
        bound.offsets[bound.n_lines++] = line->offset;
    }
    return bound;
}

double orl_footprint_equal_radius(const struct orl_footprint *footprint, double disc)
{
    const double area = ORL_PI * disc * disc;
    double radius = disc;
    for (int i = 0; i < 3; i++)
        radius *= sqrt(area / orl_larger(orl_footprint_area(footprint, radius), 0.05 * area));
    return radius;
}
