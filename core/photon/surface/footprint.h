/*
 * The surface around a point: whether two points lie on one sheet, where a facet ends, and the
 * footprint, the part of the surface that a density estimate may use, with its sides and moments.
 *
 * Two points lie on the same sheet of surface under two conditions. Their normals must be within 30
 * degrees of each other. The chord between the points must be perpendicular to the mean normal,
 * within 5 % of its length and a few cells of rounding. If the coded normals are equal the
 * tolerance is 3.5 %: a code is off by at most 1 degree, and a curve turns by no more within one
 * code. So a sheet 5 mm above another is separate from it out to 14 cm. Exact on planes, spheres
 * and cylinders; false through walls, around corners and between parallel surfaces.
 */
#ifndef ORL_PHOTON_SURFACE_FOOTPRINT_H
#define ORL_PHOTON_SURFACE_FOOTPRINT_H

#include <stdbool.h>

#include "light/lit_scene.h"
#include "photon/map/quantization.h"

/* Returns true if a chord, in cells, is perpendicular to a normal, within slope times its
 * length. */
static inline bool orl_chord_fits(struct orl_vec3 normal, struct orl_vec3 chord, double slope)
{
    const double rounding = 4, off = fabs(orl_dot(chord, normal)) - rounding;
    return off <= 0 || off * off <= slope * slope * orl_dot(chord, chord);
}

/* Slope for points whose coded normals are equal. */
static const double orl_sheet_flat_slope = 0.035;

/* Tests a chord as orl_chord_fits does with that slope, without branches. */
static inline uint32_t orl_chord_fits_flat(struct orl_vec3 normal, struct orl_vec3 chord)
{
    const double rounding = 4, off = fabs(orl_dot(chord, normal)) - rounding;
    const double most = orl_sheet_flat_slope * orl_sheet_flat_slope * orl_dot(chord, chord);
    return (uint32_t)(off <= 0) | (uint32_t)(off * off <= most);
}

/* Returns true if two points lie on the same sheet. chord: in cells; code: the coded normal of
 * the other point; own: the code of normal. */
static inline bool orl_same_sheet(struct orl_vec3 normal, uint16_t own, uint16_t code,
                                  const float chord[3])
{
    const double cosine_30 = 0.8660254037844386;
    double slope = orl_sheet_flat_slope;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    struct orl_vec3 both = normal;
    /* On flat surfaces, the most common case, the codes are equal and no normal is decoded. */
    if (code != own) {
        const struct orl_vec3 other = orl_normal_decode(code);
        if (orl_dot(other, normal) < cosine_30)
            return false;
        both = orl_scale(orl_add(other, normal), 0.5);
        slope = 0.05;
    }
    return orl_chord_fits(both, c, slope);
}

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

/*
 * Footprints: the part of a surface around a point that is reached along the surface itself, within
 * a radius. A density estimate counts only photons of the footprint, and divides by its area. So it
 * is not low beside an edge or in a corner, and not lit through a wall that stands on the surface.
 *
 * A footprint is a star of 32 sectors in the tangent plane. Its rays end where the surface ends
 * (orl_outline_exit); they follow adjacent facets that continue it, flat or gently bent. They also
 * end at objects that stand on the surface or are close above it. A ray just above the surface, and
 * a higher one, test for surfaces steeper than 45 degrees to it. Between two rays that end on one
 * straight line, the line is the exact border; otherwise the nearer end is used for the sector. So
 * a footprint lies within the true surface, except for obstacles between rays, and omits little of
 * it.
 *
 * Coordinates: azimuth in the tangent plane and the length of the chord. On planes and spheres the
 * area element in these is exact; on tubes to 0.5 %.
 *
 * Threads: pure functions of their arguments.
 */

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

/*
 * Queries of footprints: the side of the border on which small clusters of photons lie, and radii
 * at which a footprint is a whole disc or has the area of one.
 */

enum orl_side { ORL_SIDE_INSIDE, ORL_SIDE_OUTSIDE, ORL_SIDE_BOTH };

/* Photons of one plane, relative to the point: within `reach` of a middle, and in a box. */
struct orl_photon_cluster {
    struct orl_vec3 middle, low, high;
    double reach, rounding; /* rounding: that of the photons' positions */
};

/* Returns the side of the border on which a whole cluster of photons in the footprint's plane lies;
 * BOTH if that is uncertain. */
enum orl_side orl_footprint_side(const struct orl_footprint *footprint,
                                 const struct orl_photon_cluster *cluster);

/*
 * Straight lines and a radius: points within all of them lie in the footprint. Lines are given by
 * their normals in space, relative to the point.
 */
enum { ORL_BOUND_LINES = 4 };
struct orl_convex_bound {
    double radius;
    uint32_t n_lines;
    struct orl_vec3 normals[ORL_BOUND_LINES];
    double offsets[ORL_BOUND_LINES];
};

/* Returns the footprint's own lines, or a radius only if there are too many lines. */
struct orl_convex_bound orl_footprint_bound(const struct orl_footprint *footprint);

/* Returns the approximate radius within which the footprint has the area of a whole disc of
 * radius `disc`. */
double orl_footprint_equal_radius(const struct orl_footprint *footprint, double disc);

/*
 * Moments of a footprint: the area of the surface around a point, and its distribution to either
 * side. They serve estimates without bias to the side with more area.
 *
 * Coordinates are those of the footprint: x and y along its frame's u and v, lengths those of
 * chords. Units: powers of metres, from the second on.
 */

struct orl_moments {
    double area, x, y, xx, xy, yy; /* integrals of 1, x, y, x^2, x y, y^2 */
};

/* Returns the moments of a whole disc. */
static inline struct orl_moments orl_disc_moments(double radius)
{
    const double r2 = radius * radius;
    return (struct orl_moments){
        .area = ORL_PI * r2, .xx = ORL_PI / 4 * r2 * r2, .yy = ORL_PI / 4 * r2 * r2};
}

static inline struct orl_moments orl_moments_add(const struct orl_moments *a,
                                                 const struct orl_moments *b, double times)
{
    return (struct orl_moments){a->area + times * b->area, a->x + times * b->x,
                                a->y + times * b->y,       a->xx + times * b->xx,
                                a->xy + times * b->xy,     a->yy + times * b->yy};
}

/* Returns the moments of the part within a radius. */
struct orl_moments orl_footprint_moments(const struct orl_footprint *footprint, double radius);

#endif
