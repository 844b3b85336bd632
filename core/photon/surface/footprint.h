/*
 * Footprints: the part of a surface around a point that is reached along the surface itself, within
 * a radius. A density estimate counts only photons of the footprint, and divides by its area. So it
 * is not low beside an edge or in a corner, and not lit through a wall that stands on the surface.
 *
 * A footprint is a star of 32 sectors in the tangent plane. Its rays end where the surface ends
 * (outline.h); they follow adjacent facets that continue it, flat or gently bent. They also end at
 * objects that stand on the surface or are close above it. A ray just above the surface, and a
 * higher one, test for surfaces steeper than 45 degrees to it. Between two rays that end on one
 * straight line, the line is the exact border; otherwise the nearer end is used for the sector. So
 * a footprint lies within the true surface, except for obstacles between rays, and omits little of
 * it.
 *
 * Coordinates: azimuth in the tangent plane and the length of the chord. On planes and spheres the
 * area element in these is exact; on tubes to 0.5 %.
 *
 * Threads: pure functions of their arguments.
 */
#ifndef ORL_PHOTON_SURFACE_FOOTPRINT_H
#define ORL_PHOTON_SURFACE_FOOTPRINT_H

#include "photon/surface/outline.h"

enum { ORL_FOOTPRINT_SECTORS = 32 };

/* Cosine and sine of the azimuths at which sectors begin. */
extern const double orl_footprint_azimuths[ORL_FOOTPRINT_SECTORS][2];

/* A point of a surface. */
struct orl_surface_point {
    const struct orl_lit_scene *lit_scene;
    struct orl_vec3 point, normal; /* unit, on the side of the query */
    uint32_t facet;
};

/*
 * Finds the surface at a point, if one faces that way within `tolerance` along the normal. The
 * surface point's point and normal are then the surface's own. Returns false if there is none.
 */
bool orl_surface_point_find(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                            struct orl_vec3 normal, double tolerance,
                            struct orl_surface_point *ret_surface_point);

/* Returns true if the footprint of that radius is the whole disc. Fast; may return false for a
 * whole disc. */
bool orl_surface_point_is_clear(const struct orl_surface_point *surface_point, double radius);

/* Returns a radius around a surface point within which its surface is certainly flat and its own; 0
 * if it is curved. */
double orl_surface_point_flat_radius(const struct orl_surface_point *surface_point);

/* Returns true if there is no occluder between a surface point and another point of its sheet. */
bool orl_surface_point_unoccluded(const struct orl_surface_point *surface_point,
                                  struct orl_vec3 point);

struct orl_wedge {
    struct orl_line border; /* the side towards the point is inside; normal 0: no border */
    double radius;
};

struct orl_footprint {
    struct orl_frame frame;
    double clearance; /* distance within which there is no wall */
    struct orl_wedge wedges[ORL_FOOTPRINT_SECTORS];
};

void orl_footprint_make(const struct orl_surface_point *surface_point, double radius,
                        struct orl_footprint *ret_footprint);

/* Returns true if the end of a chord from the point, on the same sheet, lies in the footprint. */
bool orl_footprint_contains(const struct orl_footprint *footprint, struct orl_vec3 chord);

/* Returns the area of the part within a radius. */
double orl_footprint_area(const struct orl_footprint *footprint, double radius);

#endif
