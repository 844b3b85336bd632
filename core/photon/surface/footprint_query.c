#include "photon/surface/footprint.h"

enum { SECTORS = ORL_FOOTPRINT_SECTORS };

static bool has_border(const struct orl_wedge *wedge)
{
    return wedge->border.normal[0] != 0 || wedge->border.normal[1] != 0;
}

/* A cluster of photons in coordinates of the tangent plane. */
struct projected_cluster {
    const struct orl_photon_cluster *cluster;
    const struct orl_frame *frame;
    double x, y, distance;
};

/* Computes bounds on the signed distance of a cluster's photons to a line, from the cluster's disc
 * and its box. */
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

/* Adds the part of a disc between two azimuths, given by their cosines and sines. */
static void add_part(struct orl_moments *m, double radius, double width, const double from[2],
                     const double to[2])
{
    const double r2 = radius * radius;
    const double c0 = from[0], s0 = from[1], c1 = to[0], s1 = to[1];
    m->area += r2 / 2 * width;
    m->x += r2 * radius / 3 * (s1 - s0);
    m->y += r2 * radius / 3 * (c0 - c1);
    m->xx += r2 * r2 / 8 * (width + s1 * c1 - s0 * c0);
    m->yy += r2 * r2 / 8 * (width - s1 * c1 + s0 * c0);
    m->xy += r2 * r2 / 8 * (s1 * s1 - s0 * s0);
}

/* Adds the triangle between the point and a segment of a line, between two azimuths. */
static void add_triangle(struct orl_moments *m, const struct orl_line *line, const double from[2],
                         const double to[2])
{
    const double a = line->offset / (line->normal[0] * from[0] + line->normal[1] * from[1]);
    const double b = line->offset / (line->normal[0] * to[0] + line->normal[1] * to[1]);
    const double ax = a * from[0], ay = a * from[1], bx = b * to[0], by = b * to[1];
    const double area = 0.5 * (ax * by - ay * bx);
    m->area += area;
    m->x += area / 3 * (ax + bx);
    m->y += area / 3 * (ay + by);
    m->xx += area / 6 * (ax * ax + ax * bx + bx * bx);
    m->yy += area / 6 * (ay * ay + ay * by + by * by);
    m->xy += area / 12 * (2 * ax * ay + ax * by + ay * bx + 2 * bx * by);
}

/* Computes the azimuth (cosine and sine) where a line meets the circle, on one side of its
 * normal. */
static void intersect_circle(const struct orl_line *line, double radius, int side,
                             double ret_azimuth[2])
{
    const double c = line->offset / radius, s = side * sqrt(orl_larger(1 - c * c, 0));
    ret_azimuth[0] = line->normal[0] * c - line->normal[1] * s;
    ret_azimuth[1] = line->normal[1] * c + line->normal[0] * s;
}

/* Azimuths are cosines and sines; only widths of parts need angles. */
static void add_wedge(struct orl_moments *m, const struct orl_wedge *wedge, double radius, int at)
{
    const struct orl_line *line = &wedge->border;
    const double width = 2 * ORL_PI / ORL_FOOTPRINT_SECTORS, r = orl_smaller(radius, wedge->radius);
    const double *begin = orl_footprint_azimuths[at];
    const double *end = orl_footprint_azimuths[(at + 1) % ORL_FOOTPRINT_SECTORS];
    if ((line->normal[0] == 0 && line->normal[1] == 0) || line->offset >= r) {
        add_part(m, r, width, begin, end);
        return;
    }
    /* Within `half` of its normal the line is nearer than the circle. */
    const double half = acos(line->offset / r);
    const double normal = atan2(line->normal[1], line->normal[0]);
    const double turned = remainder(at * width - normal, 2 * ORL_PI);
    const double from = orl_smaller(orl_larger(turned, -half), half);
    const double to = orl_smaller(orl_larger(turned + width, -half), half);
    double first[2] = {begin[0], begin[1]}, last[2] = {end[0], end[1]};
    if (!(to > from)) {
        add_part(m, r, width, begin, end);
        return;
    }
    if (from > turned) {
        intersect_circle(line, r, -1, first);
        add_part(m, r, from - turned, begin, first);
    }
    if (to < turned + width) {
        intersect_circle(line, r, 1, last);
        add_part(m, r, turned + width - to, last, end);
    }
    add_triangle(m, line, first, last);
}

struct orl_moments orl_footprint_moments(const struct orl_footprint *footprint, double radius)
{
    struct orl_moments m = {0};
    for (int i = 0; i < ORL_FOOTPRINT_SECTORS; i++)
        add_wedge(&m, &footprint->wedges[i], radius, i);
    return m;
}
