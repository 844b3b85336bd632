/*
 * Where a BSDF sends the light that comes from one direction: both hemispheres as polar maps, to be
 * looked at.
 *
 * Directions are those of oriel/bsdf.h: the light comes from theta (from the normal, on its side)
 * and phi (from +x towards +y); cells lie evenly over theta and phi of the directions in which
 * light leaves, theta on their own side, phi in the same frame on both. Straight through is thus on
 * the other side at the same theta and phi + 180. The light is a beam a tenth of a degree wide.
 */
#ifndef ORIEL_BSDF_POLAR_H
#define ORIEL_BSDF_POLAR_H

#include <oriel/bsdf.h>

enum { ORL_POLAR_THETAS = 36, ORL_POLAR_PHIS = 72 }; /* cells of 2.5 by 5 degrees */

struct orl_bsdf_polar {
    double reflected, transmitted; /* of the light, by luminance: 0..1 */
    double straight;               /* of the light, what aBSDF lets pass undeviated: 0..1 */
    /* [transmitted?]: luminance of f, 1/sr, its mean over the cell by projected solid angle. */
    double values[2][ORL_POLAR_THETAS][ORL_POLAR_PHIS];
};

/* theta_deg: 0 to less than 90. Some 300000 values: about a tenth of a second. */
void orl_bsdf_polar(const struct orl_bsdf *bsdf, bool front, double theta_deg, double phi_deg,
                    struct orl_bsdf_polar *ret_polar);

#endif
