/*
 * Modifiers by name, and what was refused: at once (refusals), or when it is used (deferred
 * errors).
 */
#ifndef ORL_SCENE_PARSE_SYMBOLS_H
#define ORL_SCENE_PARSE_SYMBOLS_H

#include <sodium.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "base/memory/memory.h"

/*
 * Unsupported content of a scene: counted by kind while the rest is read, and reported all at once.
 * A scene with any of it is refused in the end.
 */

enum { ORL_REFUSALS_MAX = 24 }; /* limit of kinds; further ones are counted together */

struct orl_refusals {
    struct orl_refusal {
        char kind[48]; /* "texfunc", "!genprism" */
        uint64_t count;
        struct orl_error first;
    } kinds[ORL_REFUSALS_MAX];
    size_t n;
    uint64_t others;
};

/* Counts one refusal; err has its place, reason and hint. */
void orl_refusals_add(struct orl_refusals *refusals, const struct orl_error *err);
/* Fills err with all refusals, at the place of the first. Returns ORL_ERR_UNSUPPORTED. */
int orl_refusals_report(const struct orl_refusals *refusals, struct orl_error *err);

/*
 * Modifiers whose definition was refused; the error is reported when something uses them. Libraries
 * define a thousand materials and scenes use ten: one that is not supported, or whose numbers are
 * out of range, is harmless if no surface uses it.
 */

struct orl_deferred_error {
    const char *file, *primitive, *message, *hint; /* in the arena */
    int code, line;
    bool used;
};

struct orl_deferred_errors {
    struct orl_deferred_error *items;
    size_t count, room;
};

/* Returns true if an error in a modifier's definition can be deferred. */
static inline bool orl_is_deferrable(int code)
{
    return code == ORL_ERR_UNSUPPORTED || code == ORL_ERR_RANGE || code == ORL_ERR_NOT_FOUND;
}

/* Stores the error. Returns 0 or ORL_ERR_NOMEM. */
int orl_deferred_add(struct orl_deferred_errors *deferred, const struct orl_error *err,
                     struct orl_arena *arena, uint32_t *ret_index);

/*
 * Records a use. Unsupported modifiers are added to the refusals, once, and 0 is returned; for
 * other errors it returns their code and fills err.
 */
int orl_deferred_use(struct orl_deferred_errors *deferred, uint32_t index,
                     struct orl_refusals *refusals, struct orl_error *err);

/* Returns the first unused one, or NULL; *ret_count: number of unused ones. */
const struct orl_deferred_error *orl_deferred_unused(const struct orl_deferred_errors *deferred,
                                                     size_t *ret_count);

void orl_deferred_done(struct orl_deferred_errors *deferred);

/*
 * Modifiers by name: the latest definition of each. Names are borrowed and must outlive the table.
 */

/* REFUSED: the definition was refused; index is into the parser's deferred (orl_deferred_errors).
 * Primitives with this modifier are refused, too. */
enum orl_symbol_kind {
    ORL_SYMBOL_MATERIAL,
    ORL_SYMBOL_SKY,
    ORL_SYMBOL_PATTERN,
    ORL_SYMBOL_REFUSED
};

struct orl_symbol {
    const char *name;
    enum orl_symbol_kind kind;
    uint32_t index; /* into the parsed scene's materials, skies or patterns, or into deferred */
    uint32_t order; /* rank of this definition among all, from 1; set by the table */
};

struct orl_symbols {
    struct orl_symbol *slots;
    size_t n_slots, n_used;
    uint32_t n_set;
    unsigned char key[crypto_shorthash_KEYBYTES]; /* random, one per table */
};

/* Returns NULL if there is none. Valid until the next orl_symbols_set. */
const struct orl_symbol *orl_symbols_find(const struct orl_symbols *symbols, const char *name);
/* Adds or replaces a symbol. Returns 0 or ORL_ERR_NOMEM. */
int orl_symbols_set(struct orl_symbols *symbols, struct orl_symbol symbol);
void orl_symbols_done(struct orl_symbols *symbols);

#endif
