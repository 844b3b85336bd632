/*
 * Arithmetic on eight lanes. The result replaces the first operand. Cheap operations are done for
 * all lanes, others for the active ones only. The return value gives the active lanes whose result
 * is undefined; their value is 0. Inside of core/function only.
 */
#ifndef ORL_FUNCTION_INTERPRETER_EIGHT_LANES_H
#define ORL_FUNCTION_INTERPRETER_EIGHT_LANES_H

#include "function/function.h"

void orl_lanes_add(double *a, const double *b);
void orl_lanes_subtract(double *a, const double *b);
void orl_lanes_multiply(double *a, const double *b);
void orl_lanes_negate(double *a);
unsigned orl_lanes_divide(double *a, const double *b, unsigned active);
unsigned orl_lanes_power(double *a, const double *b, unsigned active);

/* Applies a built-in function to count arguments; the value replaces the first. At most
 * ORL_FUNCTION_PARAMETERS arguments are used. */
unsigned orl_lanes_apply(uint32_t which, double (*args)[ORL_FUNCTION_LANES], uint32_t count,
                         unsigned active);

/* Replaces n, rounded to the nearest integer, by the nth entry of a list, and 0 by the list's
 * length. */
unsigned orl_lanes_look_up(double *value, const double *list, size_t count, unsigned active);

/* Returns the lanes above zero. */
unsigned orl_lanes_above_zero(const double *a);

/* Copies the given lanes. */
void orl_lanes_copy(double *into, const double *from, unsigned lanes);

#endif
