/*
 * The CIE's clear and intermediate skies, as gensky and gendaylit use them: the formula's value at
 * the sun's distance from the zenith, and the horizontal irradiance of the sky.
 *
 * Conventions: altitude of the sun in radians. Polynomial fits are those of both programs, so that
 * the numbers agree.
 * References: CIE No. 22 (TC-4.2), 1973, for the clear sky; gensky(1) of Radiance.
 */
#ifndef ORL_SCENE_GENERATE_SKY_CIE_H
#define ORL_SCENE_GENERATE_SKY_CIE_H

enum orl_cie_type { ORL_CIE_CLEAR, ORL_CIE_INTERMEDIATE };

/* Relative luminance by which the formula is divided: A4 of skybright.cal. */
double orl_cie_shape(enum orl_cie_type type, double altitude_rad);

/* Horizontal irradiance over pi times zenith radiance. */
double orl_cie_factor(enum orl_cie_type type, double altitude_rad);

#endif
