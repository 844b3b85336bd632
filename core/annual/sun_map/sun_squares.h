/*
 * Squares of surfaces, identified by number: the square that a hit falls into, and the surface area
 * in it. Polygons are divided in their plane, round surfaces by angle and height (orl_hit_uv).
 */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_SQUARES_H
#define ORL_ANNUAL_SUN_MAP_SUN_SQUARES_H

#include "scene/geometry/geometry.h"

/* Division of a polygon into rows and columns that fit its extent, so that no slivers remain. */
struct orl_sun_sheet {
    float along[3]; /* the first axis, unit; the second is perpendicular to it in the plane */
    float low[2], step[2];
};

struct orl_sun_squares {
    const struct orl_geometry *geometry; /* borrowed */
    struct orl_sun_sheet *sheets;        /* by facet that is not instanced */
    double width;
};

/* Divides surfaces into squares of about this width. Strips narrower than three widths get eight
 * rows of longer cells. Returns 0 or ORL_ERR_NOMEM. */
int orl_sun_squares_init(struct orl_sun_squares *squares, const struct orl_geometry *geometry,
                         double width);
void orl_sun_squares_done(struct orl_sun_squares *squares);

/* Returns the identifier of the hit's square, on the side that was hit; never 0. */
uint64_t orl_sun_square_of(const struct orl_sun_squares *squares, const struct orl_hit *hit);

/* Returns the surface area in the square that a hit falls into. */
double orl_sun_square_area(const struct orl_sun_squares *squares, const struct orl_hit *hit);

#endif
