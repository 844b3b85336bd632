/*
 * Radiance's pseudo-random numbers and noise functions.
 *
 * noise3: Perlin noise (Perlin 1985) in the form of Perlin, "Improving Noise", SIGGRAPH 2002. Every
 * point of the integer lattice has one of 16 gradient directions; quintic polynomials blend the
 * gradients along each axis.
 * fnoise3: midpoint displacement in the cube of a cell, halved down to the resolution of the
 * lattice.
 * Both range from about -1 to 1; tests compare them with rtrace.
 */
#ifndef ORL_FUNCTION_INTERPRETER_NOISE_H
#define ORL_FUNCTION_INTERPRETER_NOISE_H

double orl_noise_rand(double x); /* from 0 to below 1 */
/* Returns the noise; ret_gradient may be NULL. */
double orl_noise3(const double p[3], double ret_gradient[3]);
double orl_noise_fractal3(const double p[3]);

#endif
