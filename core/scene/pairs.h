/*
 * Pairs of surfaces, by index: lists that grow.
 */
#ifndef ORL_SCENE_PAIRS_H
#define ORL_SCENE_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

struct orl_pair {
    uint32_t a, b;
};

/* Zeroed is empty; whoever has it frees the items. */
struct orl_pairs {
    struct orl_pair *items;
    size_t n, room;
};

/* False when out of memory. */
static inline bool orl_pairs_add(struct orl_pairs *pairs, uint32_t a, uint32_t b)
{
    if (pairs->n == pairs->room) {
        const size_t room = 2 * pairs->room + 16;
        struct orl_pair *grown = realloc(pairs->items, room * sizeof *grown);
        if (!grown)
            return false;
        pairs->items = grown;
        /* The items are freed by whoever has the pairs, where the analyzer does not see it. */
        pairs->room = room; // NOLINT(clang-analyzer-unix.Malloc)
    }
    pairs->items[pairs->n++] = (struct orl_pair){a, b};
    return true;
}

#endif
