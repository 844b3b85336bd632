/*
 * Where a facet ends: the outline of a polygon, the circles of a ring, the ends of a tube, and on
 * curved facets the place from where on the surface is bent too far to count as the same sheet.
 *
 * Conventions: a frame stands at a point of the facet, its n the facet's normal there, on either
 * side. Directions are unit vectors (x, y) in the frame's tangent plane, and lengths are measured
 * in that plane. Seams of keyholed polygons are part of the outline: who comes to one finds the
 * same facet beyond.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_OUTLINE_H
#define ORL_PHOTON_SURFACE_OUTLINE_H

#include "light/world.h"

/* A straight line of the tangent plane: normal[0] x + normal[1] y = offset. No line: normal 0. */
struct orl_line {
    double normal[2], offset;
};

/*
 * How far the facet goes along a direction from the frame's origin, looked for beyond `from`:
 * INFINITY when nothing ends there. ret_line is the edge crossed there, when it is a straight one.
 */
double orl_outline_exit(const struct orl_world *world, uint32_t facet,
                        const struct orl_frame *frame, struct orl_vec3 origin,
                        const double direction[2], double from, struct orl_line *ret_line);

/* A radius about a point of the facet within which it does not end; 0 when that is not known. */
double orl_outline_clearance(const struct orl_world *world, uint32_t facet, struct orl_vec3 point);

#endif
