#include "scene/symbols.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/error.h>

/* FNV-1a. */
static uint64_t hash(const char *name)
{
    uint64_t h = UINT64_C(14695981039346656037);
    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * UINT64_C(1099511628211);
    return h;
}

/* The slot that holds name, or the free one where it belongs. n_slots is a power of two. */
static struct orl_symbol *slot_of(struct orl_symbol *slots, size_t n_slots, const char *name)
{
    size_t i = (size_t)hash(name) & (n_slots - 1);
    while (slots[i].name && strcmp(slots[i].name, name) != 0)
        i = (i + 1) & (n_slots - 1);
    return slots + i;
}

const struct orl_symbol *orl_symbols_find(const struct orl_symbols *symbols, const char *name)
{
    const struct orl_symbol *slot;
    if (symbols->n_slots == 0)
        return NULL;
    slot = slot_of(symbols->slots, symbols->n_slots, name);
    return slot->name ? slot : NULL;
}

static int grow(struct orl_symbols *symbols)
{
    const size_t n_slots = symbols->n_slots ? 2 * symbols->n_slots : 256;
    struct orl_symbol *slots = calloc(n_slots, sizeof *slots);
    if (!slots)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < symbols->n_slots; i++)
        if (symbols->slots[i].name)
            *slot_of(slots, n_slots, symbols->slots[i].name) = symbols->slots[i];
    free(symbols->slots);
    symbols->slots = slots;
    symbols->n_slots = n_slots;
    return 0;
}

int orl_symbols_set(struct orl_symbols *symbols, struct orl_symbol symbol)
{
    struct orl_symbol *slot;
    if (2 * symbols->n_used >= symbols->n_slots && grow(symbols) < 0)
        return ORL_ERR_NOMEM;
    slot = slot_of(symbols->slots, symbols->n_slots, symbol.name);
    symbols->n_used += slot->name ? 0 : 1;
    *slot = symbol;
    slot->order = ++symbols->n_set;
    return 0;
}

void orl_symbols_done(struct orl_symbols *symbols)
{
    free(symbols->slots);
    memset(symbols, 0, sizeof *symbols);
}
