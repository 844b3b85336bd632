/* Texts of definitions: tokenizer, parser to trees, and the symbol table of names by context.
 * Inside of core/function only. */
#ifndef ORL_FUNCTION_LANGUAGE_DEFINITIONS_H
#define ORL_FUNCTION_LANGUAGE_DEFINITIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <oriel/base/error.h>

#include "base/memory/memory.h"
#include "function/function.h"

enum orl_function_token {
    ORL_FUNCTION_TOKEN_END,
    ORL_FUNCTION_TOKEN_NUMBER,
    ORL_FUNCTION_TOKEN_NAME,
    ORL_FUNCTION_TOKEN_SIGN
};

/* Tokenizer state; borrows the text. Tokens are numbers, names and single characters; comments are
 * skipped. One word is read ahead, in kind, word and number. */
struct orl_function_lexer {
    const char *text;
    size_t length, at;
    const char *file; /* for errors; "" if there is none */
    int line;
    enum orl_function_token kind;
    const char *word; /* not NUL-terminated */
    size_t word_length;
    double number;
};

/* Starts a text and reads its first word. */
int orl_function_lexer_begin(struct orl_function_lexer *lexer, const char *file, int line,
                             const char *text, size_t length, struct orl_error *err);
int orl_function_lexer_next(struct orl_function_lexer *lexer, struct orl_error *err);

/* Returns ORL_ERR_SYNTAX at the current word: "A is expected, not B". */
int orl_function_lexer_expected(const struct orl_function_lexer *lexer, const char *what,
                                struct orl_error *err);

/*
 * Parser of definitions, which builds trees. Names are resolved while reading, by the definitions
 * that the set has by then. Their bodies are looked up when a program is compiled, so that a
 * definition may follow its use.
 *
 * Ownership: trees, names and definitions belong to the set's arena.
 */

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
    /* The next fields are valid for the compilation of this number. */
    uint32_t compilation;
    uint32_t slot;
    bool open; /* depends on an input */
};

struct orl_definition {
    const char *name;
    int context;
    struct orl_formula variable, function;
};

/* Returns true if the first `length` bytes of text are that name. */
static inline bool orl_name_is(const char *name, const char *text, size_t length)
{
    return strncmp(name, text, length) == 0 && name[length] == '\0';
}

struct orl_functions;

/* Reads definitions of a context, up to the end of the text. */
int orl_syntax_define(struct orl_functions *functions, int context, const char *file, int line,
                      const char *text, size_t length, struct orl_error *err);

/* Reads one expression, which must be the whole text. */
int orl_syntax_expression(struct orl_functions *functions, int context, const char *file, int line,
                          const char *text, size_t length, struct orl_term **ret_root,
                          struct orl_error *err);

/* Symbol table of a set of definitions, by context (function.h). Inside of core/function only. */

struct orl_context {
    const char *name, *file; /* file: "" until it has been read */
};

struct orl_functions {
    struct orl_arena *arena;
    const char *const *inputs;
    size_t n_inputs;
    struct orl_definition **table; /* open addressing; the number of places is a power of two */
    size_t n_places, n_definitions;
    struct orl_context *contexts; /* the first is the global one */
    size_t n_contexts, contexts_room;
    size_t text_bytes;
    uint32_t n_compilations;
    uint32_t folding; /* operations left for constant folding */
    size_t work;      /* terms visited by compilations */
};

/* Meaning of a name in an expression of a context. */
struct orl_resolved_name {
    enum orl_node_kind kind; /* ORL_NODE_INPUT or ORL_NODE_NAME */
    uint32_t input;
    struct orl_definition *definition;
};

/* Resolves a name. called: the name is used as a function. Returns 0 or ORL_ERR_NOMEM. */
int orl_definitions_resolve(struct orl_functions *functions, int context, const char *name,
                            size_t length, bool called, struct orl_resolved_name *ret_resolved,
                            struct orl_error *err);

/* Returns the definition of a name in a context; creates it if there is none. NULL: out of
 * memory. */
struct orl_definition *orl_definitions_at(struct orl_functions *functions, int context,
                                          const char *name, size_t length);

/* Returns the existing definition, or NULL. */
struct orl_definition *orl_definitions_find(const struct orl_functions *functions, int context,
                                            const char *name, size_t length);

/* Returns true if a function is defined, or, unless called, a variable. False for NULL. */
bool orl_definitions_has(const struct orl_definition *definition, bool called);

/* Returns the body that a name or call refers to; NULL if the text does not define it. */
struct orl_formula *orl_body_of(const struct orl_term *node);

#endif
