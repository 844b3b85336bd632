#include "scene/storage.h"

#include <stdalign.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 1 << 20, LARGE_BYTES = BLOCK_BYTES / 4 };

struct block {
    struct block *next;
    alignas(max_align_t) char bytes[];
};

struct orl_storage {
    struct block *blocks;
    char *at; /* the free part of the newest small block */
    size_t left;
};

struct orl_storage *orl_storage_new(void)
{
    return calloc(1, sizeof(struct orl_storage));
}

void orl_storage_free(struct orl_storage *storage)
{
    if (!storage)
        return;
    for (struct block *block = storage->blocks; block;) {
        struct block *next = block->next;
        free(block);
        block = next;
    }
    free(storage);
}

static struct block *add_block(struct orl_storage *storage, size_t bytes)
{
    struct block *block;
    if (bytes > SIZE_MAX - sizeof *block)
        return NULL;
    block = malloc(sizeof *block + bytes);
    if (block) {
        block->next = storage->blocks;
        storage->blocks = block;
    }
    return block;
}

/* bytes is rounded up to keep what follows aligned; large pieces get a block of their own. */
static void *take(struct orl_storage *storage, size_t bytes)
{
    struct block *block;
    void *taken;
    if (bytes > storage->left) {
        block = add_block(storage, bytes > LARGE_BYTES ? bytes : BLOCK_BYTES);
        if (!block)
            return NULL;
        if (bytes > LARGE_BYTES)
            return block->bytes;
        storage->at = block->bytes;
        storage->left = BLOCK_BYTES;
    }
    taken = storage->at;
    storage->at += bytes;
    storage->left -= bytes;
    return taken;
}

void *orl_storage_take(struct orl_storage *storage, size_t size)
{
    const size_t align = alignof(max_align_t);
    if (size > SIZE_MAX - align)
        return NULL;
    return take(storage, (size + align - 1) / align * align);
}

char *orl_storage_text(struct orl_storage *storage, const char *text, size_t length)
{
    char *copy = length < SIZE_MAX ? orl_storage_take(storage, length + 1) : NULL;
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = '\0';
    }
    return copy;
}
