/*
 * Polar maps of the light that a BSDF scatters from one incident direction, for both hemispheres,
 * for display.
 *
 * Directions are those of oriel/bsdf/bsdf.h: the light comes from theta (from the normal, on its
 * side) and phi (from +x towards +y). Cells divide theta and phi of the outgoing direction evenly,
 * theta on their own side, phi in the same frame on both. Straight transmission is thus on the
 * other side at the same theta and phi + 180. The light is a beam a tenth of a degree wide.
 */
#ifndef ORIEL_BSDF_BSDF_POLAR_H
#define ORIEL_BSDF_BSDF_POLAR_H

#include <oriel/bsdf/bsdf.h>

enum { ORL_POLAR_THETAS = 36, ORL_POLAR_PHIS = 72 }; /* cells of 2.5 by 5 degrees */

struct orl_bsdf_polar {
    double reflected, transmitted; /* shares of the light, by luminance: 0..1 */
    double straight;               /* share of the light that aBSDF passes undeviated: 0..1 */
    /* [transmitted?]: mean luminance of f over the cell, weighted by projected solid angle,
     * 1/sr. */
    double values[2][ORL_POLAR_THETAS][ORL_POLAR_PHIS];
};

/* Fills ret_polar. theta_deg: 0 to less than 90. Evaluates some 300000 values in about a tenth of a
 * second. */
void orl_bsdf_polar(const struct orl_bsdf *bsdf, bool front, double theta_deg, double phi_deg,
                    struct orl_bsdf_polar *ret_polar);

/* Finds the peaks of a BSDF for light from one direction, each with its direction and strength. */

enum { ORL_BSDF_PEAKS = 4 };

struct orl_bsdf_lobe {
    /* Centroid of the light within 2.5 degrees; angles as in bsdf_polar.h. */
    double theta_deg, phi_deg;
    double f;     /* largest value there, 1/sr */
    double share; /* share of the incident light within 2.5 degrees of the centroid: 0..1 */
};

/* Finds the peaks of one component, brightest first. No peak lies within five degrees of a brighter
 * one. Peaks dimmer than a hundredth of the first, or than four times uniform scattering, are left
 * out. polar: for the same light. Returns the number of peaks. */
size_t orl_bsdf_find_peaks(const struct orl_bsdf *bsdf, bool front, double theta_deg,
                           double phi_deg, const struct orl_bsdf_polar *polar, bool transmitted,
                           struct orl_bsdf_lobe ret_peaks[ORL_BSDF_PEAKS]);

#endif
