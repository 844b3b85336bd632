/*
 * Footprints: the part of a surface around a point that is reached along the surface itself, within
 * a radius. A density estimate counts photons of the footprint only, and divides by its area, so
 * that it is neither low beside an edge or in a corner nor lit through a wall that stands on the
 * surface.
 *
 * A footprint is a star of 32 sectors in the tangent plane. Its rays end where the surface does
 * (outline.h; neighbouring facets that carry it on, flat or gently bent, are followed) or where
 * something stands on it or hovers close above: a ray a hair above the surface, and one higher,
 * meets what is steeper than 45 degrees to it. Between two rays that end on one straight line the
 * line is the border, exactly; otherwise the nearer end holds for the sector. So a footprint lies
 * within the true surface, but for obstacles that fit between rays, and leaves out little of it.
 *
 * Coordinates: azimuth in the tangent plane and the length of the chord. On planes and spheres the
 * area element in these is exact; on tubes to 0.5 %.
 *
 * Threads: pure functions of their arguments, so that estimates do not depend on who asks when.
 */
#ifndef ORL_PHOTON_SURFACE_FOOTPRINT_H
#define ORL_PHOTON_SURFACE_FOOTPRINT_H

#include "photon/surface/outline.h"

enum { ORL_FOOTPRINT_SECTORS = 32 };

/* Cosine and sine of the azimuths at which sectors begin. */
extern const double orl_footprint_azimuths[ORL_FOOTPRINT_SECTORS][2];

/* A point of a surface. */
struct orl_footing {
    const struct orl_world *world;
    struct orl_vec3 point, normal; /* the side asked about, unit */
    uint32_t facet;
};

/*
 * The surface at a point, if one faces that way within `tolerance` of it along the normal; the
 * footing's point and normal are then the surface's own.
 */
bool orl_footing_find(const struct orl_world *world, struct orl_vec3 point, struct orl_vec3 normal,
                      double tolerance, struct orl_footing *ret_footing);

/* Whether the footprint of that radius is the whole disc; quick, and sometimes false without need.
 */
bool orl_footing_is_free(const struct orl_footing *footing, double radius);

/* How far about a footing its surface is sure to be flat, and its own: 0 where it is curved. */
double orl_footing_flat(const struct orl_footing *footing);

/* Whether nothing stands between a footing and another point of its sheet. */
bool orl_footing_joins(const struct orl_footing *footing, struct orl_vec3 point);

struct orl_wedge {
    struct orl_line border; /* of the side towards the point */
    double radius;
};

struct orl_footprint {
    struct orl_frame frame;
    double clear; /* no wall is nearer than this */
    struct orl_wedge wedges[ORL_FOOTPRINT_SECTORS];
};

void orl_footprint_make(const struct orl_footing *footing, double radius,
                        struct orl_footprint *ret_footprint);

/* Whether the end of a chord from the point, on the same sheet, lies in the footprint. */
bool orl_footprint_holds(const struct orl_footprint *footprint, struct orl_vec3 chord);

/* Area of the part within a radius. */
double orl_footprint_area(const struct orl_footprint *footprint, double radius);

#endif
