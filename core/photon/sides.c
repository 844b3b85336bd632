#include "photon/sides.h"

enum { SECTORS = ORL_FOOTPRINT_SECTORS };

static bool has_border(const struct orl_wedge *wedge)
{
    return wedge->border.normal[0] != 0 || wedge->border.normal[1] != 0;
}

/* Of one sector: a disc at x and y, that far from the middle. */
static enum orl_side side_of(const struct orl_wedge *wedge, double x, double y, double distance,
                             double reach)
{
    const double over = has_border(wedge) ? wedge->border.normal[0] * x +
                                                wedge->border.normal[1] * y - wedge->border.offset
                                          : -INFINITY;
    const double most = fmax(over, distance - wedge->radius);
    return most + reach <= 0 ? ORL_SIDE_WITHIN : most >= reach ? ORL_SIDE_BEYOND : ORL_SIDE_BOTH;
}

enum orl_side orl_footprint_side(const struct orl_footprint *footprint, struct orl_vec3 chord,
                                 double reach)
{
    static const double width = 2 * ORL_PI / SECTORS;
    const double x = orl_dot(chord, footprint->frame.u), y = orl_dot(chord, footprint->frame.v);
    const double distance = sqrt(x * x + y * y);
    int first = 0, count = SECTORS;
    if (distance > 2 * reach) {
        /* An arc sine is less than 1.05 of its sine up to a half. */
        const double at = atan2(y, x), half = 1.05 * reach / distance;
        first = (int)floor((at - half) / width);
        count = (int)floor((at + half) / width) - first + 1;
    }
    const enum orl_side side =
        side_of(&footprint->wedges[(unsigned)first % SECTORS], x, y, distance, reach);
    for (int i = 1; i < count && side != ORL_SIDE_BOTH; i++)
        if (side_of(&footprint->wedges[(unsigned)(first + i) % SECTORS], x, y, distance, reach) !=
            side)
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
