/*
 * Conversion of spectra by CIE's standard observer of 1931 (2 degrees), and to RGB.
 *
 * RGB is Radiance's: an equal-energy spectrum of 1 is white, 1 in each channel. Colours outside the
 * gamut are moved towards grey of the same luminance until no channel is below 0. Wavelengths are
 * in nm; outside 380 to 780 the response is 0.
 *
 * Reference: CIE 15, colour-matching functions in steps of 5 nm, linear in between.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERNS_OBSERVER_H
#define ORL_SCENE_MATERIAL_PATTERNS_OBSERVER_H

#include <oriel/base/vec.h>

struct orl_tristimulus {
    double x, y, z; /* 1 each for an equal-energy spectrum of 1 */
};

/* A band of a spectrum: the wavelength of its sample, and the sample's weight in X, Y and Z. */
struct orl_spectral_band {
    double nm;
    struct orl_tristimulus weight;
};

/* Adds a value that is constant between two wavelengths, in either order. */
void orl_tristimulus_add(struct orl_tristimulus *sum, double from_nm, double to_nm, double value);

struct orl_rgb orl_tristimulus_rgb(struct orl_tristimulus seen);

#endif
