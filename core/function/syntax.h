/*
 * Texts of definitions, as trees. Names are resolved while reading, by what the set of definitions
 * knows by then (function.h); what they mean is settled when a program is compiled, so that a
 * definition may follow its use.
 *
 * Ownership: trees, names and definitions belong to the set's arena.
 */
#ifndef ORL_FUNCTION_SYNTAX_H
#define ORL_FUNCTION_SYNTAX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum orl_node_kind {
    ORL_NODE_NUMBER,
    ORL_NODE_PARAMETER,      /* of the function whose body this is */
    ORL_NODE_INPUT,          /* of the set */
    ORL_NODE_NAME,           /* a variable; as an argument also a function */
    ORL_NODE_CALL,           /* of a defined or built-in function */
    ORL_NODE_CALL_PARAMETER, /* of a function that was given as an argument */
    ORL_NODE_CHAIN,          /* operands joined from left to right by + - * / ^ */
    ORL_NODE_NEGATE,
};

struct orl_definition;

struct orl_term {
    uint8_t kind;
    bool constant; /* of the compilation under way: no parameter or input decides its value */
    uint32_t n_args;
    int line;
    union {
        double number;
        uint32_t index; /* parameter, input */
        struct orl_definition *definition;
        const char *operators; /* of a chain: one before each operand but the first */
    };
    struct orl_term **args; /* of calls; operands */
};

/* What a name stands for, as a variable or as a function. */
struct orl_formula {
    struct orl_term *root; /* NULL: not defined */
    const char *name;
    const char *file; /* "" where there is none */
    int line;
    uint32_t n_parameters;
    uint64_t called; /* the parameters that it calls, a bit each */
    /* Of the compilation under way, if its number is this: */
    uint32_t compilation;
    uint32_t slot;
    bool open; /* depends on an input */
};

struct orl_definition {
    const char *name;
    int context;
    struct orl_formula variable, function;
};

struct orl_functions;

/* Definitions of a context, to the end of the text. */
int orl_syntax_define(struct orl_functions *functions, int context, const char *file, int line,
                      const char *text, size_t length, struct orl_error *err);

/* One expression, the whole text. */
int orl_syntax_expression(struct orl_functions *functions, int context, const char *file, int line,
                          const char *text, size_t length, struct orl_term **ret_root,
                          struct orl_error *err);

#endif
