/*
 * The functions that are there without being defined: Radiance's library (rcalc(1), "Radiance File
 * Formats"), one place at a time. if() and select() choose what is evaluated, and arg() is the
 * program's: the compiler knows these.
 */
#ifndef ORL_FUNCTION_BUILTINS_H
#define ORL_FUNCTION_BUILTINS_H

#include <stdbool.h>
#include <stdint.h>

struct orl_builtin {
    const char *name;
    uint32_t least; /* arguments; more are ignored, or all taken where it says so */
    bool any_number;
    /* Sets *undefined, and returns 0, where the function has no value. */
    double (*at)(const double *args, uint32_t n, bool *undefined);
};

extern const struct orl_builtin orl_builtins[];
extern const uint32_t orl_n_builtins;

/* The place of a name in the table, or -1. */
int orl_builtin_named(const char *name);

/* a^b: 0 and *undefined where C's pow has no finite value. */
double orl_builtin_power(double a, double b, bool *undefined);

#endif
