/*
 * Growable lists of pairs of surfaces, by index.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_PAIRS_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory/array.h"

struct orl_pair {
    uint32_t a, b;
};

/* A zeroed list is empty; the owner frees the items. */
struct orl_pairs {
    struct orl_pair *items;
    size_t n, room;
};

/* Returns false if out of memory. */
static inline bool orl_pairs_add(struct orl_pairs *pairs, uint32_t a, uint32_t b)
{
    if (!orl_array_reserve(&pairs->items, &pairs->room, pairs->n, sizeof *pairs->items))
        return false;
    pairs->items[pairs->n++] = (struct orl_pair){a, b};
    return true;
}

#endif
