/*
 * Radiance's pseudo-random number and noises, place by place.
 *
 * noise3: Perlin's noise (Perlin 1985), a value and a gradient drawn at every point of the integer
 * lattice, between which Hermite's cubics interpolate along one axis after another (Ward, "A
 * Recursive Implementation of the Perlin Noise Function", Graphics Gems II, p. 396).
 * fnoise3: midpoint displacement in the cell's cube, halved until it is as small as a number can
 * tell. Both from -1 to 1, nearly; compared with rtrace in tests.
 */
#ifndef ORL_FUNCTION_NOISE_H
#define ORL_FUNCTION_NOISE_H

double orl_noise_rand(double x); /* from 0 to below 1 */
/* ret_gradient may be NULL. */
double orl_noise3(const double p[3], double ret_gradient[3]);
double orl_noise_fractal3(const double p[3]);

#endif
