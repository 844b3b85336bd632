/*
 * Arena: memory that is allocated piece by piece and freed all at once. A scene has millions of
 * names and vertex lists with the same lifetime. One call to the allocator for each would cost more
 * than parsing them.
 *
 * Ownership: the arena owns what orl_arena_alloc returns. Threads: one at a time.
 */
#ifndef ORL_BASE_MEMORY_ARENA_H
#define ORL_BASE_MEMORY_ARENA_H

#include <stddef.h>

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

#endif
