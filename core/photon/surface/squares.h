/*
 * A grid of rectangles over a facet's plane: finds the one that a point falls in, and the surface
 * area in each, for any outline of the facet.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_SQUARES_H
#define ORL_PHOTON_SURFACE_SQUARES_H

#include "photon/surface/plane.h"

/* Grid; squares are numbered row by row from `first` on. */
struct orl_squares {
    uint32_t first, across, down; /* empty grid: across is 0 */
    double width, height;         /* size of one square */
};

/* Returns the number of the square that holds a point of the plane; beyond the grid, of the
 * nearest one. */
static inline uint32_t orl_squares_index(const struct orl_squares *squares, struct orl_corner at)
{
    const double x = fmin(fmax(at.x / squares->width, 0), squares->across - 1);
    const double y = fmin(fmax(at.y / squares->height, 0), squares->down - 1);
    return squares->first + (uint32_t)y * squares->across + (uint32_t)x;
}

/* Adds to every square, by its number, the area of the triangles in it. */
void orl_squares_add(const struct orl_squares *squares, const struct orl_flat *flats,
                     uint32_t triangles, float *areas);

/* Returns the number of the square with the most surface, among a square and its four
 * neighbours. */
uint32_t orl_squares_fullest(const struct orl_squares *squares, const float *areas, uint32_t x,
                             uint32_t y);

#endif
