/*
 * A grid of squares over a facet's plane: which of them a point falls in, and how much of each is
 * surface, whatever the facet's outline.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_SQUARES_H
#define ORL_PHOTON_SURFACE_SQUARES_H

#include "photon/surface/plane.h"

/* Numbered row by row, from `first` on. */
struct orl_squares {
    uint32_t first, across, down; /* none: across is 0 */
    double width, height;         /* of a square */
};

/* The number of a plane's point's square; of points beyond the grid, that of the nearest. */
static inline uint32_t orl_squares_index(const struct orl_squares *squares, struct orl_corner at)
{
    const double x = fmin(fmax(at.x / squares->width, 0), squares->across - 1);
    const double y = fmin(fmax(at.y / squares->height, 0), squares->down - 1);
    return squares->first + (uint32_t)y * squares->across + (uint32_t)x;
}

/* Adds to every square, by its number, the area that triangles of the plane have in it. */
void orl_squares_add(const struct orl_squares *squares, const struct orl_flat *flats,
                     uint32_t triangles, float *areas);

/* Of a square's four neighbours the number of the one that is most surface; or its own. */
uint32_t orl_squares_fullest(const struct orl_squares *squares, const float *areas, uint32_t x,
                             uint32_t y);

#endif
