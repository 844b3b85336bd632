/*
 * What gensky and gendaylit take from the CIE's clear and intermediate skies: the formula's value
 * at the sun's distance from the zenith, and the horizontal irradiance such a sky gives.
 *
 * Conventions: altitude of the sun in radians. Fits by polynomial, as both programs have them, so
 * that their numbers agree with ours.
 * References: CIE No. 22 (TC-4.2), 1973, for the clear sky; gensky(1) of Radiance.
 */
#ifndef ORL_SCENE_GENERATE_CIE_H
#define ORL_SCENE_GENERATE_CIE_H

enum orl_cie_type { ORL_CIE_CLEAR, ORL_CIE_INTERMEDIATE };

/* The relative luminance that is divided out: A4 of skybright.cal. */
double orl_cie_shape(enum orl_cie_type type, double altitude_rad);

/* Horizontal irradiance over pi times zenith radiance. */
double orl_cie_factor(enum orl_cie_type type, double altitude_rad);

#endif
