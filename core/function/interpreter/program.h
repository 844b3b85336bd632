/* Compiled program. Inside of core/function only. */
#ifndef ORL_FUNCTION_INTERPRETER_PROGRAM_H
#define ORL_FUNCTION_INTERPRETER_PROGRAM_H

#include "function/interpreter/machine.h"

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

#endif
