/*
 * Modifiers by name: the latest definition of each. Names are borrowed and must outlive the table.
 */
#ifndef ORL_SCENE_PARSE_SYMBOLS_H
#define ORL_SCENE_PARSE_SYMBOLS_H

#include <sodium.h>
#include <stddef.h>
#include <stdint.h>

/* REFUSED: the definition was refused; index is into the parser's deferred (deferred_errors.h).
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
    uint32_t index; /* into the description's materials, skies or patterns, or into deferred */
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
