/*
 * Radiance of the sky in a direction: the patterns that gendaylit (Perez et al. 1993) and gensky
 * (CIE clear, intermediate, overcast, uniform) write, ground half included.
 */
#ifndef ORL_LIGHT_SKY_H
#define ORL_LIGHT_SKY_H

#include "scene/parsed_scene.h"

/* Returns skybright(direction) as Radiance's perezlum.cal / skybright.cal define it; direction
 * is unit. */
double orl_sky_brightness(const struct orl_sky *sky, struct orl_vec3 direction);

/*
 * Returns the irradiance of a horizontal surface from the sky's upper half, W/m2 per channel, by
 * quadrature. Its relative error is at most 1e-6 for any position of the sun.
 */
double orl_sky_horizontal(const struct orl_sky *sky);

#endif
