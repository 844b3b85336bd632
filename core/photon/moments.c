#include "photon/moments.h"

/* A part of a disc between two azimuths, by their cosines and sines. */
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

/* Its width may be negative. */
static void add_sector(struct orl_moments *m, double radius, double from, double to)
{
    if (to < from || to > from)
        add_part(m, radius, to - from, (const double[2]){cos(from), sin(from)},
                 (const double[2]){cos(to), sin(to)});
}

/* The triangle of the point and a piece of a line, between two azimuths. */
static void add_triangle(struct orl_moments *m, const struct orl_line *line, double from, double to)
{
    if (!(to > from))
        return;
    const double c0 = cos(from), s0 = sin(from), c1 = cos(to), s1 = sin(to);
    const double a = line->offset / (line->normal[0] * c0 + line->normal[1] * s0);
    const double b = line->offset / (line->normal[0] * c1 + line->normal[1] * s1);
    const double ax = a * c0, ay = a * s0, bx = b * c1, by = b * s1;
    const double area = 0.5 * (ax * by - ay * bx);
    m->area += area;
    m->x += area / 3 * (ax + bx);
    m->y += area / 3 * (ay + by);
    m->xx += area / 6 * (ax * ax + ax * bx + bx * bx);
    m->yy += area / 6 * (ay * ay + ay * by + by * by);
    m->xy += area / 12 * (2 * ax * ay + ax * by + ay * bx + 2 * bx * by);
}

static void add_wedge(struct orl_moments *m, const struct orl_wedge *wedge, double radius, int at)
{
    const struct orl_line *line = &wedge->border;
    const double width = 2 * ORL_PI / ORL_FOOTPRINT_SECTORS, r = fmin(radius, wedge->radius);
    const double start = at * width;
    if ((line->normal[0] == 0 && line->normal[1] == 0) || line->offset >= r) {
        add_part(m, r, width, orl_footprint_azimuths[at],
                 orl_footprint_azimuths[(at + 1) % ORL_FOOTPRINT_SECTORS]);
        return;
    }
    /* Within `half` of its normal the line is nearer than the circle. */
    const double half = acos(line->offset / r);
    const double normal = atan2(line->normal[1], line->normal[0]);
    const double turned = remainder(start - normal, 2 * ORL_PI);
    const double from = fmin(fmax(turned, -half), half);
    const double to = fmin(fmax(turned + width, -half), half);
    add_sector(m, r, start, start + from - turned);
    add_triangle(m, line, start + from - turned, start + to - turned);
    add_sector(m, r, start + to - turned, start + width);
}

struct orl_moments orl_footprint_moments(const struct orl_footprint *footprint, double radius)
{
    struct orl_moments m = {0};
    for (int i = 0; i < ORL_FOOTPRINT_SECTORS; i++)
        add_wedge(&m, &footprint->wedges[i], radius, i);
    return m;
}
