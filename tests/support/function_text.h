/* The function language in tests: text in, a value out. */
#ifndef ORL_TESTS_SUPPORT_FUNCTION_TEXT_H
#define ORL_TESTS_SUPPORT_FUNCTION_TEXT_H

#include "function/function.h"

extern const double function_tolerance; /* 1e-12, relative to the larger of 1 and the value */

/* Fixtures of a group of tests, which share one scratch. */
int function_set_up(void **state);
int function_tear_down(void **state);
extern struct orl_function_scratch *function_scratch;

/* Compiles the definitions and the expression, with A1 to A3 = 5, 6, 7. Returns NULL and err if
 * refused. */
struct orl_function *function_compile(const char *definitions, const char *expression,
                                      struct orl_error *err);
/* Returns the value for these ray inputs (NULL: none needed); ret_outcome may be NULL. */
double function_value(const char *definitions, const char *expression, const double *inputs,
                      struct orl_function_outcome *ret_outcome);
void function_check_near(const char *expression, double value, double right);

#endif
