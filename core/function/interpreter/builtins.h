/*
 * Built-in functions: Radiance's library (rcalc(1), "Radiance File Formats"), evaluated for one
 * lane at a time. The compiler handles if() and select(), which choose their operands, and arg(),
 * which reads the program's arguments.
 */
#ifndef ORL_FUNCTION_INTERPRETER_BUILTINS_H
#define ORL_FUNCTION_INTERPRETER_BUILTINS_H

#include <stdbool.h>
#include <stdint.h>

struct orl_builtin {
    const char *name;
    uint32_t
        min_args; /* fewest arguments; further ones are ignored, or all are used if any_number */
    bool is_variadic;
    /* Sets *undefined and returns 0 where the function is undefined. */
    double (*at)(const double *args, uint32_t n, bool *undefined);
};

extern const struct orl_builtin orl_builtins[];
extern const uint32_t orl_n_builtins;

/* Returns the index of a name in the table, or -1. */
int orl_builtin_named(const char *name);

/* Returns a^b. Returns 0 and sets *undefined where C's pow has no finite value. */
double orl_builtin_power(double a, double b, bool *undefined);

#endif
