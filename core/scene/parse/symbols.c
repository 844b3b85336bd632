#include "scene/parse/symbols.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

/* SipHash with a random key per table, so that input cannot force collisions. The position of a
 * name does not affect results. */
static uint64_t hash_name(const struct orl_symbols *symbols, const char *name)
{
    uint64_t h;
    unsigned char bytes[crypto_shorthash_BYTES];
    crypto_shorthash(bytes, (const unsigned char *)name, strlen(name), symbols->key);
    memcpy(&h, bytes, sizeof h);
    return h;
}

/* Returns the slot that holds name, or the free one where it belongs. n_slots is a power of two. */
static struct orl_symbol *slot_of(const struct orl_symbols *symbols, struct orl_symbol *slots,
                                  size_t n_slots, const char *name)
{
    size_t i = (size_t)hash_name(symbols, name) & (n_slots - 1);
    while (slots[i].name && strcmp(slots[i].name, name) != 0)
        i = (i + 1) & (n_slots - 1);
    return slots + i;
}

const struct orl_symbol *orl_symbols_find(const struct orl_symbols *symbols, const char *name)
{
    const struct orl_symbol *slot;
    if (symbols->n_slots == 0)
        return NULL;
    slot = slot_of(symbols, symbols->slots, symbols->n_slots, name);
    return slot->name ? slot : NULL;
}

static int grow_table(struct orl_symbols *symbols)
{
    const size_t n_slots = symbols->n_slots ? 2 * symbols->n_slots : 256;
    struct orl_symbol *slots = calloc(n_slots, sizeof *slots);
    if (!slots)
        return ORL_ERR_NOMEM;
    if (symbols->n_slots == 0)
        randombytes_buf(symbols->key, sizeof symbols->key);
    for (size_t i = 0; i < symbols->n_slots; i++)
        if (symbols->slots[i].name)
            *slot_of(symbols, slots, n_slots, symbols->slots[i].name) = symbols->slots[i];
    free(symbols->slots);
    symbols->slots = slots;
    symbols->n_slots = n_slots;
    return 0;
}

int orl_symbols_set(struct orl_symbols *symbols, struct orl_symbol symbol)
{
    struct orl_symbol *slot;
    if (2 * symbols->n_used >= symbols->n_slots && grow_table(symbols) < 0)
        return ORL_ERR_NOMEM;
    slot = slot_of(symbols, symbols->slots, symbols->n_slots, symbol.name);
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
