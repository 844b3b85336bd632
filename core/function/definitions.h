/*
 * What the names of a set of definitions stand for, context by context (function.h).
 * Inside of core/function only.
 */
#ifndef ORL_FUNCTION_DEFINITIONS_H
#define ORL_FUNCTION_DEFINITIONS_H

#include "base/arena.h"
#include "function/function.h"
#include "function/syntax.h"

struct orl_context {
    const char *name, *file; /* file: "" until it has been read */
};

struct orl_functions {
    struct orl_arena *arena;
    const char *const *inputs;
    size_t n_inputs;
    struct orl_definition **table; /* open addressing; a power of two of places */
    size_t n_places, n_definitions;
    struct orl_context *contexts; /* the first is the global one */
    size_t n_contexts, contexts_room;
    size_t text_bytes;
    uint32_t n_compilations;
    uint32_t folding; /* operations left for constants */
    size_t work;      /* terms looked at by compilations */
};

/* What an expression of a context means by a name. */
struct orl_meaning {
    enum orl_node_kind kind; /* ORL_NODE_INPUT or ORL_NODE_NAME */
    uint32_t input;
    struct orl_definition *definition;
};

/* 0, or ORL_ERR_NOMEM. called: the name is a function's. */
int orl_definitions_mean(struct orl_functions *functions, int context, const char *name,
                         size_t length, bool called, struct orl_meaning *ret_meaning,
                         struct orl_error *err);

/* The definition of a context by that name, made if there is none. NULL: out of memory. */
struct orl_definition *orl_definitions_at(struct orl_functions *functions, int context,
                                          const char *name, size_t length);

/* The one there is, or NULL. */
struct orl_definition *orl_definitions_find(const struct orl_functions *functions, int context,
                                            const char *name, size_t length);

/* Whether it stands for something: as a function, or, unless called, as a variable. NULL: no. */
bool orl_definitions_has(const struct orl_definition *definition, bool called);

/* What a name or call refers to; NULL: not defined in the text. */
struct orl_formula *orl_body_of(const struct orl_term *node);

#endif
