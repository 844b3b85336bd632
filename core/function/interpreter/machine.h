/*
 * Programs, the stack machine that runs them, and built-in functions. Each value has eight lanes.
 * Inside of core/function only.
 *
 * A program consists of segments of instructions, one for each expression, variable and function
 * that it needs; they lie one after another. Inactive lanes are computed too if that costs nothing;
 * their results are ignored. Where lanes branch differently, both branches are executed, each for
 * its lanes.
 */
#ifndef ORL_FUNCTION_INTERPRETER_MACHINE_H
#define ORL_FUNCTION_INTERPRETER_MACHINE_H

#include <stdbool.h>
#include <stdint.h>

#include "function/function.h"

enum orl_operation {
    ORL_OP_NUMBER,    /* pushes the number */
    ORL_OP_INPUT,     /* index: pushes the input */
    ORL_OP_PARAMETER, /* index: pushes the argument's value */
    ORL_OP_VARIABLE,  /* index: segment, evaluated once; pushes its value */
    ORL_OP_ARG,       /* replaces n by the nth argument of the program */
    ORL_OP_ADD,       /* ADD to POWER replace the two top values by one */
    ORL_OP_SUBTRACT,
    ORL_OP_MULTIPLY,
    ORL_OP_DIVIDE,
    ORL_OP_POWER,
    ORL_OP_NEGATE,
    ORL_OP_BUILTIN,        /* index, count: replaces count arguments by the value */
    ORL_OP_CALL,           /* index: call site; pushes the value */
    ORL_OP_CALL_PARAMETER, /* index: call site */
    ORL_OP_IF,             /* pops the condition; index: past the ELSE of the other branch */
    ORL_OP_ELSE,           /* index: the END */
    ORL_OP_END,
    ORL_OP_SELECT, /* count: number of choices; n stays below the chosen value */
    ORL_OP_CASE,   /* count: number of the case; index: next case */
    ORL_OP_CHOSEN,
    ORL_OP_END_SELECT,
    ORL_OP_TABLE, /* index, count: replaces n by the nth of count numbers */
    ORL_OP_JUMP,  /* index: target within the segment */
    ORL_OP_RETURN,
};

struct orl_instruction {
    uint32_t operation;
    uint32_t count;
    union {
        uint64_t index;
        double number;
    };
};

enum orl_argument_kind {
    ORL_ARGUMENT_CODE,      /* index: instruction in the caller's segment */
    ORL_ARGUMENT_PARAMETER, /* index: parameter of the caller */
    ORL_ARGUMENT_FUNCTION,  /* index: segment */
    ORL_ARGUMENT_BUILTIN,   /* index: entry of orl_builtins */
};

struct orl_argument {
    uint32_t kind, index;
};

/* Call site. */
struct orl_call_site {
    uint32_t callee; /* segment, or parameter */
    uint32_t first;  /* index of the first argument */
    uint32_t n;
};

struct orl_segment {
    struct orl_instruction *code;
    size_t n, room;
    uint32_t n_parameters;
    uint32_t variable; /* index among variables, if is_variable */
    bool is_variable;
    bool finished; /* true: the segment can be run */
    bool is_used;  /* true: part of the program; others served compilation only */
};

/* Borrowed by the machine. The compiler also runs incomplete programs. */
struct orl_program {
    const struct orl_segment *segments;
    const struct orl_call_site *sites;
    const struct orl_argument *arguments;
    const double *tables;
    const double *args; /* arg(1), ... */
    size_t n_args;
    uint32_t n_variables;
};

/* Runs the segment for the given lanes and stores the value in ret_value. *operations counts
 * down. */
struct orl_function_outcome orl_machine_run(const struct orl_program *program,
                                            struct orl_function_scratch *scratch, uint32_t segment,
                                            const struct orl_function_lanes *inputs, unsigned lanes,
                                            uint32_t *operations,
                                            struct orl_function_lanes *ret_value);

/* Resets all variables before a program's first expression at a point. Returns false if there are
 * too many. */
bool orl_machine_begin(const struct orl_program *program, struct orl_function_scratch *scratch);

/* Compiled program. Inside of core/function only. */

struct orl_function {
    struct orl_program program;   /* view of the arrays below */
    struct orl_instruction *code; /* code of all segments */
    struct orl_segment *segments;
    struct orl_call_site *sites;
    struct orl_argument *arguments;
    double *tables, *args;
    size_t n_code, n_segments, n_sites, n_arguments, n_tables;
    size_t n_expressions, n_inputs;
    uint64_t inputs, fixed_inputs;
    uint32_t operations;
};

/*
 * Built-in functions: Radiance's library (rcalc(1), "Radiance File Formats"), evaluated for one
 * lane at a time. The compiler handles if() and select(), which choose their operands, and arg(),
 * which reads the program's arguments.
 */

struct orl_builtin {
    const char *name;
    uint32_t
        min_args; /* fewest arguments; further ones are ignored, or all are used if any_number */
    bool is_variadic;
    /* One of these is set. The first two are undefined where they are not finite. */
    double (*of_number)(double arg);
    double (*of_numbers)(const double *args);
    double (*at)(const double *args, uint32_t n, bool *undefined);
};

extern const struct orl_builtin orl_builtins[];
extern const uint32_t orl_n_builtins;

/* Returns the value of an entry of the table for n arguments. Sets *undefined and returns 0 where
 * the function is undefined. */
double orl_builtin_apply(uint32_t which, const double *args, uint32_t n, bool *undefined);

/* Returns the index of a name in the table, or -1. */
int orl_builtin_named(const char *name);

/* Returns a^b. Returns 0 and sets *undefined where C's pow has no finite value. */
double orl_builtin_power(double a, double b, bool *undefined);

#endif
