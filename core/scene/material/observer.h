/*
 * What an eye makes of a spectrum: CIE's standard observer of 1931 (2 degrees), and RGB of it.
 *
 * RGB is Radiance's (bsdf/color.h): an even spectrum of 1 is white, 1 in each channel. Colours
 * outside its triangle are moved towards grey of the same luminance, until no channel is below 0.
 * Wavelengths in nm; outside 380 to 780 nothing is seen.
 *
 * Reference: CIE 15, colour-matching functions in steps of 5 nm, linear in between.
 */
#ifndef ORL_SCENE_MATERIAL_OBSERVER_H
#define ORL_SCENE_MATERIAL_OBSERVER_H

#include <oriel/vec.h>

struct orl_tristimulus {
    double x, y, z; /* of an even spectrum of 1: 1 each */
};

/* A part of a spectrum: at what wavelength it is asked for, and what its value then counts for. */
struct orl_band {
    double nm;
    struct orl_tristimulus weight;
};

/* Adds a value that holds between two wavelengths, either of which may be the longer. */
void orl_observe(struct orl_tristimulus *sum, double from_nm, double to_nm, double value);

struct orl_rgb orl_observed_rgb(struct orl_tristimulus seen);

#endif
