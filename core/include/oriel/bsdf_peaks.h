/*
 * Where a BSDF's light from one direction is brightest: its peaks, each with its place and what is
 * about it.
 */
#ifndef ORIEL_BSDF_PEAKS_H
#define ORIEL_BSDF_PEAKS_H

#include <oriel/bsdf_polar.h>

enum { ORL_BSDF_PEAKS = 4 };

struct orl_bsdf_lobe {
    double theta_deg, phi_deg; /* as in bsdf_polar.h: the middle of the light within 2.5 degrees */
    double f;                  /* the largest value there, 1/sr */
    double share;              /* of the light that comes, within 2.5 degrees of that: 0..1 */
};

/* The brightest of one part first, none within five degrees of a brighter one, and none dimmer than
 * a hundredth of the first or than four times what even light would be. polar: of the same light.
 * Returns how many.
 */
size_t orl_bsdf_find_peaks(const struct orl_bsdf *bsdf, bool front, double theta_deg,
                           double phi_deg, const struct orl_bsdf_polar *polar, bool transmitted,
                           struct orl_bsdf_lobe ret_peaks[ORL_BSDF_PEAKS]);

#endif
