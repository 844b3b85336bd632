/*
 * Test whether two points lie on the same sheet of surface. Their normals must be within 30 degrees
 * of each other. The chord between the points must be perpendicular to the mean normal, within 5 %
 * of its length and a few cells of rounding. If the coded normals are equal the tolerance is 3.5 %:
 * a code is off by at most 1 degree, and a curve turns by no more within one code. So a sheet 5 mm
 * above another is separate from it out to 14 cm. Exact on planes, spheres and cylinders; false
 * through walls, around corners and between parallel surfaces.
 */
#ifndef ORL_PHOTON_SURFACE_SURFACE_SHEET_H
#define ORL_PHOTON_SURFACE_SURFACE_SHEET_H

#include <stdbool.h>

#include "photon/map/normal_code.h"

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

#endif
