#include "photon/sides.h"

enum { SECTORS = ORL_FOOTPRINT_SECTORS };

static bool has_border(const struct orl_wedge *wedge)
{
    return wedge->border.normal[0] != 0 || wedge->border.normal[1] != 0;
}

/* A patch in the tangent plane. */
struct flat {
    const struct orl_patch *patch;
    const struct orl_frame *frame;
    double x, y, distance;
};

/* How far a patch reaches over a line, at least and at most: its disc does, or its box. */
static void over_line(const struct flat *flat, const struct orl_line *line, double *ret_least,
                      double *ret_most)
{
    const struct orl_patch *p = flat->patch;
    const struct orl_frame *f = flat->frame;
    const double *n = line->normal;
    const double over = n[0] * flat->x + n[1] * flat->y, x = n[0] * f->u.x + n[1] * f->v.x,
                 y = n[0] * f->u.y + n[1] * f->v.y, z = n[0] * f->u.z + n[1] * f->v.z;
    const double most = x * (x > 0 ? p->high.x : p->low.x) + y * (y > 0 ? p->high.y : p->low.y) +
                        z * (z > 0 ? p->high.z : p->low.z);
    const double least = x * (x > 0 ? p->low.x : p->high.x) + y * (y > 0 ? p->low.y : p->high.y) +
                         z * (z > 0 ? p->low.z : p->high.z);
    *ret_least = fmax(over - p->reach, least) - line->offset;
    *ret_most = fmin(over + p->reach, most) - line->offset;
}

static enum orl_side side_of(const struct flat *flat, const struct orl_wedge *wedge)
{
    const double reach = flat->patch->reach, rounding = flat->patch->rounding;
    double least = -INFINITY, most = -INFINITY;
    if (has_border(wedge))
        over_line(flat, &wedge->border, &least, &most);
    if (flat->distance - reach >= wedge->radius || least > rounding)
        return ORL_SIDE_BEYOND;
    return flat->distance + reach <= wedge->radius && most <= rounding ? ORL_SIDE_WITHIN
                                                                       : ORL_SIDE_BOTH;
}

enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_patch *patch)
{
    static const double width = 2 * ORL_PI / SECTORS;
    const double x = orl_dot(patch->middle, footprint->frame.u);
    const double y = orl_dot(patch->middle, footprint->frame.v);
    const struct flat flat = {patch, &footprint->frame, x, y, sqrt(x * x + y * y)};
    int first = 0, count = SECTORS;
    if (flat.distance > 2 * patch->reach) {
        /* An arc sine is less than 1.05 of its sine up to a half. */
        const double at = atan2(y, x), half = 1.05 * patch->reach / flat.distance;
        first = (int)floor((at - half) / width);
        count = (int)floor((at + half) / width) - first + 1;
    }
    const enum orl_side side = side_of(&flat, &footprint->wedges[(unsigned)first % SECTORS]);
    for (int i = 1; i < count && side != ORL_SIDE_BOTH; i++)
        if (side_of(&flat, &footprint->wedges[(unsigned)(first + i) % SECTORS]) != side)
            return ORL_SIDE_BOTH;
    return side;
}

double orl_footprint_inner(const struct orl_footprint *footprint)
{
    double inner = INFINITY;
    for (int i = 0; i < SECTORS; i++) {
        const struct orl_wedge *wedge = &footprint->wedges[i];
        inner = fmin(inner,
                     has_border(wedge) ? fmin(wedge->radius, wedge->border.offset) : wedge->radius);
    }
    return inner;
}

double orl_footprint_even(const struct orl_footprint *footprint, double disc)
{
    const double area = ORL_PI * disc * disc;
    double radius = disc;
    for (int i = 0; i < 3; i++)
        radius *= sqrt(area / fmax(orl_footprint_area(footprint, radius), 0.05 * area));
    return radius;
}
