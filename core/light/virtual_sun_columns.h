/*
 * Bounds on the points from which a sun's image may be visible. All rays towards an image have one
 * direction. So the mirrors that show it are projected onto a plane across that direction, which is
 * cut into square columns. Each column holds how far along the direction its farthest mirror lies.
 * A point can see the image only if its column has a mirror before it; otherwise no shadow ray is
 * needed.
 *
 * Conservative: mirrors are enlarged by the sun's disc and by rounding errors, so no visible image
 * is missed.
 */
#ifndef ORL_LIGHT_VIRTUAL_SUN_COLUMNS_H
#define ORL_LIGHT_VIRTUAL_SUN_COLUMNS_H

#include <stdbool.h>

#include <oriel/base/vec.h>

#include "scene/geometry/geometry.h"

enum { ORL_VIRTUAL_SUN_COLUMNS = 64 };

struct orl_virtual_sun_columns {
    /* origin and columns per unit of length on the plane that the mirrors are projected onto */
    double low[2], per_unit[2];
    float farthest[ORL_VIRTUAL_SUN_COLUMNS]
                  /* position of the farthest mirror along the direction; -INFINITY: none */
                  [ORL_VIRTUAL_SUN_COLUMNS];
};

/* Builds the columns. frame.n: the direction in which the image is seen; half_angle: that of its
 * disc, radians; shows: per facet, true if it is a mirror that shows the image. */
void orl_virtual_sun_columns_build(struct orl_virtual_sun_columns *columns,
                                   const struct orl_geometry *geometry,
                                   const struct orl_frame *frame, double half_angle,
                                   const bool *shows);

/* Returns true if the image may be visible from a point. */
static inline bool orl_virtual_sun_columns_show(const struct orl_virtual_sun_columns *columns,
                                                const struct orl_frame *frame,
                                                struct orl_vec3 point)
{
    const double x = (orl_dot(frame->u, point) - columns->low[0]) * columns->per_unit[0];
    const double y = (orl_dot(frame->v, point) - columns->low[1]) * columns->per_unit[1];
    return x >= 0 && y >= 0 && x < ORL_VIRTUAL_SUN_COLUMNS && y < ORL_VIRTUAL_SUN_COLUMNS &&
           orl_dot(frame->n, point) < (double)columns->farthest[(int)y][(int)x];
}

#endif
