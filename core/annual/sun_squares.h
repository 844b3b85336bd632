/*
 * Squares of surfaces, by name: which one a hit falls into, and how much surface there is in it.
 * Polygons are laid out in their plane; other surfaces by turn and height (orl_hit_uv).
 */
#ifndef ORL_ANNUAL_SUN_SQUARES_H
#define ORL_ANNUAL_SUN_SQUARES_H

#include "scene/geometry/geometry.h"

/* How a polygon is laid out: in rows and columns that fit its extent, lest slivers remain. */
struct orl_sun_sheet {
    float along[3]; /* the first axis; the second is at right angles in the plane */
    float low[2], step[2];
};

struct orl_sun_squares {
    const struct orl_geometry *geometry; /* borrowed */
    struct orl_sun_sheet *sheets;        /* of each facet of the scene's own */
    double width;
};

/* Squares about so wide; of strips narrower than a few of them, longer ones in eight rows. Returns
 * 0 or ORL_ERR_NOMEM. */
int orl_sun_squares_init(struct orl_sun_squares *squares, const struct orl_geometry *geometry,
                         double width);
void orl_sun_squares_done(struct orl_sun_squares *squares);

/* The name of the square, of the side that was met; never 0. */
uint64_t orl_sun_square_of(const struct orl_sun_squares *squares, const struct orl_hit *hit);

/* The area of surface in the square that a hit falls into. */
double orl_sun_square_area(const struct orl_sun_squares *squares, const struct orl_hit *hit);

#endif
