#include <stdalign.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

enum { BLOCK_BYTES = 1 << 20, LARGE_BYTES = BLOCK_BYTES / 4 };

struct block {
    struct block *next;
    alignas(double) char bytes[];
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

/* Makes room for a small allocation in the newest block, or allocates a separate block for a large
 * one. */
static bool make_room(struct orl_arena *arena, size_t bytes, void **ret_own)
{
    *ret_own = NULL;
    if (bytes <= arena->left)
        return true;
    struct block *const block = add_block(arena, bytes > LARGE_BYTES ? bytes : BLOCK_BYTES);
    if (!block)
        return false;
    if (bytes > LARGE_BYTES) {
        *ret_own = block->bytes;
    } else {
        arena->at = block->bytes;
        arena->left = BLOCK_BYTES;
    }
    return true;
}

/* Takes bytes from the front of the block; `bytes` is a multiple of the alignment. */
static void *take_from_front(struct orl_arena *arena, size_t bytes)
{
    void *taken;
    if (!make_room(arena, bytes, &taken) || taken)
        return taken;
    taken = arena->at;
    arena->at += bytes;
    arena->left -= bytes;
    return taken;
}

void *orl_arena_alloc(struct orl_arena *arena, size_t size)
{
    const size_t align = alignof(double);
    if (size > SIZE_MAX - align)
        return NULL;
    return take_from_front(arena, (size + align - 1) / align * align);
}

/* Takes bytes from the back of the block, which needs no alignment. */
char *orl_arena_alloc_chars(struct orl_arena *arena, size_t size)
{
    void *taken;
    if (!make_room(arena, size, &taken) || taken)
        return taken;
    arena->left -= size;
    return arena->at + arena->left;
}

char *orl_arena_copy_text(struct orl_arena *arena, const char *text, size_t length)
{
    char *copy = length < SIZE_MAX ? orl_arena_alloc_chars(arena, length + 1) : NULL;
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}

struct orl_array_block {
    struct orl_array_block *next;
    alignas(max_align_t) char bytes[];
};

void *orl_arrays_new(struct orl_arrays *arrays, size_t count, size_t item)
{
    const size_t most = SIZE_MAX - sizeof(struct orl_array_block);
    struct orl_array_block *block = NULL;
    if (!arrays->failed && (item == 0 || count <= most / item))
        block = calloc(1, sizeof *block + count * item);
    if (!block) {
        arrays->failed = true;
        return NULL;
    }
    block->next = arrays->newest;
    arrays->newest = block;
    return block->bytes;
}

void orl_arrays_free(struct orl_arrays *arrays)
{
    for (struct orl_array_block *block = arrays->newest; block;) {
        struct orl_array_block *const next = block->next;
        free(block);
        block = next;
    }
    *arrays = (struct orl_arrays){.newest = NULL};
}

static size_t size_of_spans(const struct orl_span *spans, size_t n)
{
    size_t bytes = 0;
    for (size_t i = 0; i < n; i++)
        bytes += spans[i].bytes;
    return bytes;
}

void *orl_spans_join(const struct orl_span *spans, size_t n, size_t *ret_bytes)
{
    *ret_bytes = size_of_spans(spans, n);
    char *data = malloc(*ret_bytes + 1), *to = data;
    for (size_t i = 0; data && i < n; to += spans[i++].bytes)
        if (spans[i].bytes > 0)
            memcpy(to, spans[i].at, spans[i].bytes);
    return data;
}

bool orl_spans_fill(const struct orl_span *spans, size_t n, const void *data, size_t bytes)
{
    const char *from = data;
    if (!data || bytes != size_of_spans(spans, n))
        return false;
    for (size_t i = 0; i < n; from += spans[i++].bytes)
        if (spans[i].bytes > 0)
            memcpy(spans[i].at, from, spans[i].bytes);
    return true;
}

bool orl_array_reserve(void *array, size_t *capacity, size_t count, size_t item)
{
    return orl_array_reserve_more(array, capacity, count, 1, item);
}

bool orl_array_reserve_more(void *array, size_t *capacity, size_t count, size_t more, size_t item)
{
    void **pointer = array;
    size_t wanted = *capacity ? 2 * *capacity : 16;
    if (count + more <= *capacity)
        return true;
    if (wanted < count + more)
        wanted = count + more;
    void *const grown = realloc(*pointer, wanted * item);
    if (!grown)
        return false;
    *pointer = grown;
    *capacity = wanted;
    return true;
}
