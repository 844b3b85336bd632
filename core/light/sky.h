/*
 * Radiance of the sky in a direction: the patterns that gendaylit (Perez et al. 1993) and gensky
 * (CIE clear, intermediate, overcast, uniform) write, ground half included.
 */
#ifndef ORL_LIGHT_SKY_H
#define ORL_LIGHT_SKY_H

#include "scene/description.h"

/* skybright(direction) as Radiance's perezlum.cal / skybright.cal define it; direction is unit. */
double orl_sky_brightness(const struct orl_sky *sky, struct orl_vec3 direction);

/*
 * The irradiance that the sky's upper half gives a horizontal surface, W/m2 per channel, by
 * quadrature: good to 1e-6 of itself, wherever the sun stands.
 */
double orl_sky_horizontal(const struct orl_sky *sky);

#endif
