/*
 * A grid of rectangles over a facet's plane: finds the one that a point falls in, and the surface
 * area in each, for any outline of the facet.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_FACET_GRID_H
#define ORL_PHOTON_SURFACE_FACET_GRID_H

#include "photon/surface/facet_plane.h"

/* Grid; cells are numbered row by row from `first` on. */
struct orl_facet_grid {
    uint32_t first, columns, rows; /* empty grid: across is 0 */
    double width, height;          /* size of one cell */
};

/* Returns the number of the cell that holds a point of the plane; beyond the grid, of the
 * nearest one. */
static inline uint32_t orl_facet_grid_index(const struct orl_facet_grid *grid,
                                            struct orl_plane_point at)
{
    const double x = fmin(fmax(at.x / grid->width, 0), grid->columns - 1);
    const double y = fmin(fmax(at.y / grid->height, 0), grid->rows - 1);
    return grid->first + (uint32_t)y * grid->columns + (uint32_t)x;
}

/* Adds to every cell, by its number, the area of the triangles in it. */
void orl_facet_grid_add_areas(const struct orl_facet_grid *grid,
                              const struct orl_plane_triangle *plane_triangles, uint32_t triangles,
                              float *areas);

/* Returns the number of the cell with the most surface, among a cell and its four
 * neighbours. */
uint32_t orl_facet_grid_fullest(const struct orl_facet_grid *grid, const float *areas, uint32_t x,
                                uint32_t y);

#endif
