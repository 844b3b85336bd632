/*
 * From where a sun's image may be seen at all. Whoever looks towards an image looks along one
 * direction; so the mirrors that show it are put on a plane across that direction, cut into square
 * columns, and each column keeps how far along it the farthest mirror lies. A place sees the image
 * only where its column has a mirror before it: where not, no shadow ray is needed.
 *
 * Never denies what a ray might find: mirrors are grown by what the sun's disc and rounding make.
 */
#ifndef ORL_LIGHT_IMAGE_COLUMNS_H
#define ORL_LIGHT_IMAGE_COLUMNS_H

#include <stdbool.h>

#include <oriel/vec.h>

#include "scene/geometry/geometry.h"

enum { ORL_COLUMNS_ACROSS = 64 };

struct orl_image_columns {
    double low[2], per_unit[2]; /* of the plane that all mirrors lie on */
    float farthest[ORL_COLUMNS_ACROSS]
                  [ORL_COLUMNS_ACROSS]; /* along the direction; -INFINITY: none */
};

/* frame.n: the direction that the image is seen in; half_angle: of its disc, radians. shows: by
 * facet, which mirrors show it. */
void orl_image_columns_build(struct orl_image_columns *columns, const struct orl_geometry *geometry,
                             const struct orl_frame *frame, double half_angle, const bool *shows);

/* Whether the image may be seen from there. */
static inline bool orl_image_columns_may_show(const struct orl_image_columns *columns,
                                              const struct orl_frame *frame, struct orl_vec3 point)
{
    const double x = (orl_dot(frame->u, point) - columns->low[0]) * columns->per_unit[0];
    const double y = (orl_dot(frame->v, point) - columns->low[1]) * columns->per_unit[1];
    return x >= 0 && y >= 0 && x < ORL_COLUMNS_ACROSS && y < ORL_COLUMNS_ACROSS &&
           orl_dot(frame->n, point) < (double)columns->farthest[(int)y][(int)x];
}

#endif
