/* Symbol table of a set of definitions, by context (function.h). Inside of core/function only. */
#ifndef ORL_FUNCTION_LANGUAGE_DEFINITIONS_H
#define ORL_FUNCTION_LANGUAGE_DEFINITIONS_H

#include "base/memory/arena.h"
#include "function/function.h"
#include "function/language/syntax.h"

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
