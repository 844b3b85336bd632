/*
 * Parser of definitions, which builds trees. Names are resolved while reading, by the definitions
 * that the set has by then (function.h). Their bodies are looked up when a program is compiled, so
 * that a definition may follow its use.
 *
 * Ownership: trees, names and definitions belong to the set's arena.
 */
#ifndef ORL_FUNCTION_LANGUAGE_SYNTAX_H
#define ORL_FUNCTION_LANGUAGE_SYNTAX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum orl_node_kind {
    ORL_NODE_NUMBER,
    ORL_NODE_PARAMETER,      /* parameter of the enclosing function */
    ORL_NODE_INPUT,          /* input of the set */
    ORL_NODE_NAME,           /* a variable; as an argument also a function */
    ORL_NODE_CALL,           /* call of a defined or built-in function */
    ORL_NODE_CALL_PARAMETER, /* call of a function passed as an argument */
    ORL_NODE_CHAIN,          /* operands joined from left to right by + - * / ^ */
    ORL_NODE_NEGATE,
};

struct orl_definition;

struct orl_term {
    uint8_t kind;
    bool constant; /* for the current compilation: the value depends on no parameter and no input
                      that is not fixed */
    uint32_t n_args;
    int line;
    union {
        double number;
        uint32_t index; /* parameter or input */
        struct orl_definition *definition;
        const char *operators; /* chains: one before each operand, the first unused */
    };
    struct orl_term **args; /* arguments of a call, or operands */
};

/* Body of a variable or of a function. */
struct orl_formula {
    struct orl_term *root; /* NULL: not defined */
    const char *name;
    const char *file; /* "" if there is none */
    int line;
    uint32_t n_parameters;
    uint64_t called; /* parameters that it calls, as bits */
    /* The next members are valid for the compilation of this number. */
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

/* Reads definitions of a context, up to the end of the text. */
int orl_syntax_define(struct orl_functions *functions, int context, const char *file, int line,
                      const char *text, size_t length, struct orl_error *err);

/* Reads one expression, which must be the whole text. */
int orl_syntax_expression(struct orl_functions *functions, int context, const char *file, int line,
                          const char *text, size_t length, struct orl_term **ret_root,
                          struct orl_error *err);

#endif
