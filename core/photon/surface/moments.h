/*
 * Moments of a footprint: the area of the surface around a point, and its distribution to either
 * side. They serve estimates without bias to the side with more area.
 *
 * Coordinates are those of the footprint (footprint.h): x and y along its frame's u and v, lengths
 * those of chords. Units: powers of metres, from the second on.
 */
#ifndef ORL_PHOTON_SURFACE_MOMENTS_H
#define ORL_PHOTON_SURFACE_MOMENTS_H

#include "photon/surface/footprint.h"

struct orl_moments {
    double area, x, y, xx, xy, yy; /* integrals of 1, x, y, x^2, x y, y^2 */
};

/* Returns the moments of a whole disc. */
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

/* Returns the moments of the part within a radius. */
struct orl_moments orl_footprint_moments(const struct orl_footprint *footprint, double radius);

#endif
