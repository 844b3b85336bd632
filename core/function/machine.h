/*
 * Programs and the machine that runs them: a stack of values, each of eight lanes. Inside of
 * core/function only.
 *
 * A program is segments of instructions, one for each expression, variable and function that it
 * needs; they lie one after another. Lanes that are not active compute too, where that costs
 * nothing, and are ignored. Where lanes choose differently both ways are gone, each by its lanes.
 */
#ifndef ORL_FUNCTION_MACHINE_H
#define ORL_FUNCTION_MACHINE_H

#include "function/function.h"

enum orl_operation {
    ORL_OP_NUMBER,    /* pushes it */
    ORL_OP_INPUT,     /* index: pushes it */
    ORL_OP_PARAMETER, /* index: pushes an argument's value */
    ORL_OP_VARIABLE,  /* index: a segment, evaluated once; pushes its value */
    ORL_OP_ARG,       /* replaces n by the nth of the program's arguments */
    ORL_OP_ADD,       /* these replace the two uppermost values by one */
    ORL_OP_SUBTRACT,
    ORL_OP_MULTIPLY,
    ORL_OP_DIVIDE,
    ORL_OP_POWER,
    ORL_OP_NEGATE,
    ORL_OP_BUILTIN,        /* index, count: replaces count arguments by the value */
    ORL_OP_CALL,           /* index: a site; pushes the value */
    ORL_OP_CALL_PARAMETER, /* index: a site */
    ORL_OP_IF,             /* takes the condition; index: past the other way's ELSE */
    ORL_OP_ELSE,           /* index: the END */
    ORL_OP_END,
    ORL_OP_SELECT, /* count: how many there are to choose from; n stays below the choice */
    ORL_OP_CASE,   /* count: which; index: the next one */
    ORL_OP_CHOSEN,
    ORL_OP_END_SELECT,
    ORL_OP_TABLE, /* index, count: replaces n by the nth of these numbers */
    ORL_OP_JUMP,  /* index: where to, in this segment */
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
    ORL_ARGUMENT_CODE,      /* index: an instruction of the caller's segment */
    ORL_ARGUMENT_PARAMETER, /* index: the caller's own */
    ORL_ARGUMENT_FUNCTION,  /* index: a segment */
    ORL_ARGUMENT_BUILTIN,   /* index: of orl_builtins */
};

struct orl_argument {
    uint32_t kind, index;
};

/* A place that calls a function. */
struct orl_site {
    uint32_t callee; /* a segment; or a parameter */
    uint32_t first;  /* of its arguments */
    uint32_t n;
};

struct orl_segment {
    struct orl_instruction *code;
    size_t n, room;
    uint32_t n_parameters;
    uint32_t variable; /* its place among variables, where it is one */
    bool is_variable;
    bool finished; /* until then nothing runs it */
    bool is_used;  /* by the program; others served to compile it */
};

/* Borrowed by the machine; the compiler runs programs that are not complete. */
struct orl_program {
    const struct orl_segment *segments;
    const struct orl_site *sites;
    const struct orl_argument *arguments;
    const double *tables;
    const double *args; /* arg(1), ... */
    size_t n_args;
    uint32_t n_variables;
};

/* Runs the segment for these lanes, leaving the value in ret_value. *operations counts down. */
struct orl_function_outcome orl_machine_run(const struct orl_program *program,
                                            struct orl_function_scratch *scratch, uint32_t segment,
                                            const struct orl_function_lanes *inputs, unsigned lanes,
                                            uint32_t *operations,
                                            struct orl_function_lanes *ret_value);

/* Before a program's first expression at a place: no variable has a value. False: too many. */
bool orl_machine_begin(const struct orl_program *program, struct orl_function_scratch *scratch);

#endif
