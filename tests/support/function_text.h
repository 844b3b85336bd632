/* The function language as tests use it: text in, a value out. */
#ifndef ORL_TESTS_SUPPORT_FUNCTION_TEXT_H
#define ORL_TESTS_SUPPORT_FUNCTION_TEXT_H

#include "function/function.h"

extern const double function_tolerance; /* 1e-12, of the larger of 1 and the value */

/* Of a group of tests; the scratch is one for all of them. */
int function_set_up(void **state);
int function_tear_down(void **state);
extern struct orl_function_scratch *function_scratch;

/* The definitions, then the expression, with A1 to A3 = 5, 6, 7. NULL: refused, with err. */
struct orl_function *function_compile(const char *definitions, const char *expression,
                                      struct orl_error *err);
/* Its value where ray inputs are these (NULL: none is needed); ret_outcome may be NULL. */
double function_value(const char *definitions, const char *expression, const double *inputs,
                      struct orl_function_outcome *ret_outcome);
void function_check_near(const char *expression, double value, double right);

#endif
