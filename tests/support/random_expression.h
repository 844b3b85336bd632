/* Random expressions of the function language: equal seeds give equal texts. */
#ifndef ORL_TESTS_SUPPORT_RANDOM_EXPRESSION_H
#define ORL_TESTS_SUPPORT_RANDOM_EXPRESSION_H

#include <stddef.h>
#include <stdint.h>

/*
 * Definitions that the expressions use: variables, functions, recursion, functions of functions.
 * One line each, before the expression.
 */
extern const char *const random_expression_definitions;

/* Writes an expression of at most size - 1 characters. */
void random_expression_write(uint64_t seed, char *ret_text, size_t size);

#endif
