#include "photon/surface/moments.h"

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

/* Adds the triangle between the point and a piece of a line, between two azimuths. */
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
