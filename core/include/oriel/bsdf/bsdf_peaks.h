/* Finds the peaks of a BSDF for light from one direction, each with its direction and strength. */
#ifndef ORIEL_BSDF_BSDF_PEAKS_H
#define ORIEL_BSDF_BSDF_PEAKS_H

#include <oriel/bsdf/bsdf_polar.h>

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
