/*
 * Moments of a footprint: how much of a surface there is about a point, and to which side of it.
 * What estimates need that do not lean to the side where there is more room.
 *
 * Coordinates are those of the footprint (footprint.h): x and y along its frame's u and v, lengths
 * those of chords. Units: metres to the power of two and more.
 */
#ifndef ORL_PHOTON_SURFACE_MOMENTS_H
#define ORL_PHOTON_SURFACE_MOMENTS_H

#include "photon/surface/footprint.h"

struct orl_moments {
    double area, x, y, xx, xy, yy; /* integrals of 1, x, y, x^2, x y, y^2 */
};

/* Of a whole disc. */
static inline struct orl_moments orl_disc_moments(double radius)
{
    const double r2 = radius * radius;
    return (struct orl_moments){
        .area = ORL_PI * r2, .xx = ORL_PI / 4 * r2 * r2, .yy = ORL_PI / 4 * r2 * r2};
}

static inline struct orl_moments orl_moments_add(const struct orl_moments *a,
                                                 const struct orl_moments *b, double times)
{
    return (struct orl_moments){a->area + times * b->area, a->x + times * b->x,
                                a->y + times * b->y,       a->xx + times * b->xx,
                                a->xy + times * b->xy,     a->yy + times * b->yy};
}

/* Of the part within a radius. */
struct orl_moments orl_footprint_moments(const struct orl_footprint *footprint, double radius);

#endif
