/*
 * Where a facet ends: the outline of a polygon, the circles of a ring, the ends of a tube. Curved
 * facets end where the surface is bent too far to count as the same sheet.
 *
 * Conventions: a frame is at a point of the facet, its n is the facet's normal there, on either
 * side. Directions are unit vectors (x, y) in the frame's tangent plane, and lengths are measured
 * in that plane. Seams of keyholed polygons are part of the outline: the same facet continues
 * beyond them.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_OUTLINE_H
#define ORL_PHOTON_SURFACE_OUTLINE_H

#include "light/lit_scene.h"

/* A straight line in the tangent plane: normal[0] x + normal[1] y = offset. Normal 0: no line. */
struct orl_line {
    double normal[2], offset;
};

/*
 * Returns the length at which the facet ends along a direction from the frame's origin, searched
 * beyond `from`; INFINITY if it does not end. *ret_line is the edge crossed there, if it is
 * straight.
 */
double orl_outline_exit(const struct orl_lit_scene *lit_scene, uint32_t facet,
                        const struct orl_frame *frame, struct orl_vec3 origin,
                        const double direction[2], double from, struct orl_line *ret_line);

/* Returns a radius around a point of the facet within which the facet does not end; 0 if
 * unknown. */
double orl_outline_clearance(const struct orl_lit_scene *lit_scene, uint32_t facet,
                             struct orl_vec3 point);

#endif
