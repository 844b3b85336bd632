#include "base/arena.h"

#include <stdalign.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 1 << 20, LARGE_BYTES = BLOCK_BYTES / 4 };

struct block {
    struct block *next;
    alignas(max_align_t) char bytes[];
};

struct orl_arena {
    struct block *blocks;
    char *at; /* the free part of the newest small block */
    size_t left;
};

struct orl_arena *orl_arena_new(void)
{
    return calloc(1, sizeof(struct orl_arena));
}

void orl_arena_free(struct orl_arena *arena)
{
    if (!arena)
        return;
    for (struct block *block = arena->blocks; block;) {
        struct block *next = block->next;
        free(block);
        block = next;
    }
    free(arena);
}

static struct block *add_block(struct orl_arena *arena, size_t bytes)
{
    struct block *block;
    if (bytes > SIZE_MAX - sizeof *block)
        return NULL;
    block = malloc(sizeof *block + bytes);
    if (block) {
        block->next = arena->blocks;
        arena->blocks = block;
    }
    return block;
}

/* bytes is rounded up to keep what follows aligned; large pieces get a block of their own. */
static void *take(struct orl_arena *arena, size_t bytes)
{
    struct block *block;
    void *taken;
    if (bytes > arena->left) {
        block = add_block(arena, bytes > LARGE_BYTES ? bytes : BLOCK_BYTES);
        if (!block)
            return NULL;
        if (bytes > LARGE_BYTES)
            return block->bytes;
        arena->at = block->bytes;
        arena->left = BLOCK_BYTES;
    }
    taken = arena->at;
    arena->at += bytes;
    arena->left -= bytes;
    return taken;
}

void *orl_arena_take(struct orl_arena *arena, size_t size)
{
    const size_t align = alignof(max_align_t);
    if (size > SIZE_MAX - align)
        return NULL;
    return take(arena, (size + align - 1) / align * align);
}

char *orl_arena_text(struct orl_arena *arena, const char *text, size_t length)
{
    char *copy = length < SIZE_MAX ? orl_arena_take(arena, length + 1) : NULL;
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}
