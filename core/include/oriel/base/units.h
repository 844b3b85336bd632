/*
 * Physical constants and conversions, with their sources. Quantities carry their unit as a suffix
 * elsewhere: _m, _rad, _sr, _w, _lm, _lx.
 */
#ifndef ORIEL_BASE_UNITS_H
#define ORIEL_BASE_UNITS_H

#define ORL_PI 3.14159265358979323846

/* Luminous efficacy of equal-energy white, lm/W: Radiance, src/common/color.h (WHTEFFICACY). */
#define ORL_EFFICACY_LM_PER_W 179.0

/* Radiance's default RGB primaries: the luminance of each, summing to 1 (src/common/color.h). */
#define ORL_LUMA_R 0.265074126
#define ORL_LUMA_G 0.670114631
#define ORL_LUMA_B 0.064811243

/* Mean angular diameter of the solar disc, degrees, as gendaylit writes it; gensky writes 0.5. */
#define ORL_SUN_DIAMETER_DEG 0.533

#define ORL_DEG_TO_RAD (ORL_PI / 180.0)

/* Horizontal illuminance outdoors under the CIE overcast sky; reference of daylight factors. */
#define ORL_OVERCAST_LX 10000.0

#endif
