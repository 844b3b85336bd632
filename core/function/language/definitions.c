#include "function/language/definitions.h"

#include <stdlib.h>
#include <string.h>

/* FNV-1a hash of the context and the name. */
static uint64_t hash_of(int context, const char *name, size_t length)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325) ^ (uint64_t)context;
    for (size_t i = 0; i < length; i++)
        hash = (hash ^ (unsigned char)name[i]) * UINT64_C(0x100000001b3);
    return hash ^ hash >> 29;
}

static bool is_named(const struct orl_definition *definition, int context, const char *name,
                     size_t length)
{
    return definition->context == context && orl_name_is(definition->name, name, length);
}

/* Returns the table entry of a name, or the empty entry for it. */
static struct orl_definition **place_in(struct orl_definition **table, size_t n_places, int context,
                                        const char *name, size_t length)
{
    size_t at = hash_of(context, name, length) & (n_places - 1);
    while (table[at] && !is_named(table[at], context, name, length))
        at = (at + 1) & (n_places - 1);
    return &table[at];
}

static bool grow_table(struct orl_functions *functions)
{
    const size_t n = functions->n_places ? 2 * functions->n_places : 256;
    struct orl_definition **const table = calloc(n, sizeof(struct orl_definition *));
    if (!table)
        return false;
    for (size_t i = 0; i < functions->n_places; i++) {
        struct orl_definition *const one = functions->table[i];
        if (one)
            *place_in(table, n, one->context, one->name, strlen(one->name)) = one;
    }
    free(functions->table);
    functions->table = table;
    functions->n_places = n;
    return true;
}

struct orl_definition *orl_definitions_find(const struct orl_functions *functions, int context,
                                            const char *name, size_t length)
{
    return functions->n_places
               ? *place_in(functions->table, functions->n_places, context, name, length)
               : NULL;
}

struct orl_definition *orl_definitions_at(struct orl_functions *functions, int context,
                                          const char *name, size_t length)
{
    if (2 * functions->n_definitions >= functions->n_places && !grow_table(functions))
        return NULL;
    struct orl_definition **const place =
        place_in(functions->table, functions->n_places, context, name, length);
    if (*place)
        return *place;
    struct orl_definition *const made = orl_arena_alloc(functions->arena, sizeof *made);
    if (!made)
        return NULL;
    memset(made, 0, sizeof *made);
    made->name = orl_arena_copy_text(functions->arena, name, length);
    if (!made->name)
        return NULL;
    made->context = context;
    made->variable.name = made->function.name = made->name;
    functions->n_definitions++;
    return *place = made;
}

bool orl_definitions_has(const struct orl_definition *definition, bool called)
{
    return definition && (definition->function.root || (!called && definition->variable.root));
}

/* Returns the context that the last part of name`context names, or -1. */
static int context_named(const struct orl_functions *functions, const char *name, size_t length,
                         size_t *ret_length)
{
    size_t mark = length;
    while (mark > 0 && name[mark - 1] != '`')
        mark--;
    for (size_t i = 1; mark > 1 && i < functions->n_contexts; i++)
        if (orl_name_is(functions->contexts[i].name, name + mark, length - mark)) {
            *ret_length = mark - 1;
            return (int)i;
        }
    return -1;
}

static bool find_input(const struct orl_functions *functions, const char *name, size_t length,
                       uint32_t *ret_input)
{
    for (size_t i = 0; i < functions->n_inputs; i++)
        if (orl_name_is(functions->inputs[i], name, length)) {
            *ret_input = (uint32_t)i;
            return true;
        }
    return false;
}

int orl_definitions_resolve(struct orl_functions *functions, int context, const char *name,
                            size_t length, bool called, struct orl_resolved_name *ret_resolved,
                            struct orl_error *err)
{
    struct orl_resolved_name resolved = {.kind = ORL_NODE_NAME};
    const bool local = length > 1 && name[0] == '`';
    const bool global = length > 1 && !local && name[length - 1] == '`';
    if (local)
        name++;
    length -= (size_t)(local || global);
    if (global)
        context = ORL_FUNCTION_GLOBAL;
    struct orl_definition *found = orl_definitions_find(functions, context, name, length);
    if (!local && !orl_definitions_has(found, called)) {
        struct orl_definition *const outer =
            orl_definitions_find(functions, ORL_FUNCTION_GLOBAL, name, length);
        size_t shorter = length;
        const int other = context_named(functions, name, length, &shorter);
        if (orl_definitions_has(outer, called))
            found = outer;
        else if (!called && find_input(functions, name, length, &resolved.input))
            resolved.kind = ORL_NODE_INPUT;
        else if (other > 0)
            found = orl_definitions_find(functions, other, name, shorter);
    }
    if (resolved.kind == ORL_NODE_NAME && !found)
        found = orl_definitions_at(functions, context, name, length);
    if (resolved.kind == ORL_NODE_NAME && !found)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for definitions");
    resolved.definition = found;
    *ret_resolved = resolved;
    return 0;
}

struct orl_formula *orl_body_of(const struct orl_term *node)
{
    struct orl_definition *const definition = node->definition;
    if (node->kind == ORL_NODE_NAME && definition->variable.root)
        return &definition->variable;
    return definition->function.root ? &definition->function : NULL;
}
