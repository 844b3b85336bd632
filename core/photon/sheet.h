/*
 * Whether two points lie on the same sheet of surface: normals within 30 degrees of each other, and
 * the chord between the points square to the mean normal, within 5 % of its length (2 % where the
 * coded normals agree: a code is off by 1 degree at most) and a few cells of rounding. So a
 * sheet 5 mm above another stays apart from it out to 25 cm. Exact on planes, spheres and
 * cylinders; false through walls, around corners and between parallel surfaces.
 */
#ifndef ORL_PHOTON_SHEET_H
#define ORL_PHOTON_SHEET_H

#include <stdbool.h>

#include "photon/facing.h"

/* chord in cells; code: the coded normal of the other point; own: that of normal. */
static inline bool orl_same_sheet(struct orl_vec3 normal, uint16_t own, uint16_t code,
                                  const float chord[3])
{
    const double cosine_30 = 0.8660254037844386, rounding = 4;
    double slope = 0.02;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    struct orl_vec3 both = normal;
    /* On flat surfaces, that is nearly always, the codes agree and there is nothing to decode. */
    if (code != own) {
        const struct orl_vec3 other = orl_normal_decode(code);
        if (orl_dot(other, normal) < cosine_30)
            return false;
        both = orl_scale(orl_add(other, normal), 0.5);
        slope = 0.05;
    }
    const double off = fabs(orl_dot(c, both)) - rounding;
    return off <= 0 || off * off <= slope * slope * orl_dot(c, c);
}

#endif
