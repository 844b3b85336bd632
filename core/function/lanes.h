/*
 * Arithmetic of eight lanes. The first operand is replaced; what costs little is done for all
 * lanes, the rest for those that are active. Results are the lanes, among these, that have no
 * value: they are 0. Inside of core/function only.
 */
#ifndef ORL_FUNCTION_LANES_H
#define ORL_FUNCTION_LANES_H

#include "function/function.h"

void orl_lanes_add(double *a, const double *b);
void orl_lanes_subtract(double *a, const double *b);
void orl_lanes_multiply(double *a, const double *b);
void orl_lanes_negate(double *a);
unsigned orl_lanes_divide(double *a, const double *b, unsigned active);
unsigned orl_lanes_power(double *a, const double *b, unsigned active);

/* A built-in function of count arguments, whose value replaces the first. At most
 * ORL_FUNCTION_PARAMETERS of them are taken. */
unsigned orl_lanes_apply(uint32_t which, double (*args)[ORL_FUNCTION_LANES], uint32_t count,
                         unsigned active);

/* Replaces n, to the nearest integer, by the nth of a list; 0 by how many there are. */
unsigned orl_lanes_look_up(double *value, const double *list, size_t count, unsigned active);

/* The lanes above zero. */
unsigned orl_lanes_above_zero(const double *a);

/* Copies these lanes. */
void orl_lanes_take(double *into, const double *from, unsigned lanes);

#endif
