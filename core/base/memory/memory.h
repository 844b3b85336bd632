/*
 * Memory: arenas, arrays that are freed together, growable arrays (oriel/base/array.h), large
 * blocks.
 *
 * An arena is memory that is allocated in small amounts and freed all at once. A scene has millions
 * of names and vertex lists with the same lifetime. One call to the allocator for each would cost
 * more than parsing them.
 *
 * Ownership: the arena owns what orl_arena_alloc returns. Threads: one at a time.
 */
#ifndef ORL_BASE_MEMORY_MEMORY_H
#define ORL_BASE_MEMORY_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <sys/mman.h>

#include <oriel/base/array.h>

struct orl_arena;

struct orl_arena *orl_arena_new(void);        /* NULL when out of memory */
void orl_arena_free(struct orl_arena *arena); /* NULL is allowed */

/* Returns `size` bytes, aligned for numbers, pointers and structs of them, not cleared. NULL when
 * out of memory. */
void *orl_arena_alloc(struct orl_arena *arena, size_t size);

/* Returns unaligned bytes for text, packed densely. NULL when out of memory. */
char *orl_arena_alloc_chars(struct orl_arena *arena, size_t size);

/* Returns a NUL-terminated copy of `length` bytes. NULL when out of memory. */
char *orl_arena_copy_text(struct orl_arena *arena, const char *text, size_t length);

/* Frees a list of n texts, which may be NULL. */
static inline void orl_texts_free(char **texts, size_t n)
{
    for (size_t i = 0; texts && i < n; i++)
        free(texts[i]);
    free(texts);
}

/*
 * Arrays that are freed together. Zeros: no array yet. Once memory runs out, `failed` stays true,
 * and further arrays are NULL; so one check after the last array suffices.
 */
struct orl_arrays {
    struct orl_array_block *newest;
    bool failed;
};

/* Returns an array of zeros, owned by `arrays`. An array of no items is not NULL. */
void *orl_arrays_new(struct orl_arrays *arrays, size_t count, size_t item);
/* Frees all arrays and makes the struct zeros. */
void orl_arrays_free(struct orl_arrays *arrays);

/* A range of bytes; borrowed. */
struct orl_span {
    void *at;
    size_t bytes;
};

/* Returns a copy of the spans one after the other, owned by the caller. NULL when out of memory. */
void *orl_spans_join(const struct orl_span *spans, size_t n, size_t *ret_bytes);
/* Fills the spans from a copy that orl_spans_join made. Returns false, and fills none, if the copy
 * is NULL or has another size. */
bool orl_spans_fill(const struct orl_span *spans, size_t n, const void *data, size_t bytes);

/* Allocation of large blocks, and early release of memory that is no longer needed. */

/*
 * Same as malloc, and freed by free. A large block requests huge pages: page faults for small pages
 * would take longer than filling the block.
 */
static inline void *orl_memory_new(size_t bytes)
{
    const size_t huge = (size_t)2 << 20;
    if (bytes < 2 * huge || bytes > SIZE_MAX - huge)
        return malloc(bytes);
    void *memory = aligned_alloc(huge, (bytes + huge - 1) / huge * huge);
#ifdef MADV_HUGEPAGE
    /* Only a hint. */
    if (memory)
        madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return memory;
}

/*
 * Releases the pages that lie completely between two addresses of memory from malloc. Their content
 * is lost; the memory stays allocated. For arrays that are read once, from front to back, while
 * another one is filled: together they use no more than one.
 */
static inline void orl_memory_release_pages(const void *begin, const void *end)
{
    const uintptr_t page = 4096;
    const uintptr_t first = ((uintptr_t)begin + page - 1) / page * page;
    const uintptr_t last = (uintptr_t)end / page * page;
    if (first < last)
        madvise((void *)first, last - first, MADV_DONTNEED);
}

#endif
