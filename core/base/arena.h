/*
 * Storage: memory that is handed out piece by piece and given back all at once. A scene has
 * millions of names and vertex lists that live and die together; one call to the allocator for each
 * would cost more than parsing them.
 *
 * Ownership: what orl_arena_take returns belongs to the arena. Threads: one at a time.
 */
#ifndef ORL_BASE_ARENA_H
#define ORL_BASE_ARENA_H

#include <stddef.h>

struct orl_arena;

struct orl_arena *orl_arena_new(void);        /* NULL when out of memory */
void orl_arena_free(struct orl_arena *arena); /* NULL is allowed */

/* size bytes, aligned for numbers and pointers and what is made of them, not cleared. NULL when out
 * of memory. */
void *orl_arena_take(struct orl_arena *arena, size_t size);

/* The same for letters, which are packed. */
char *orl_arena_letters(struct orl_arena *arena, size_t size);

/* A NUL-terminated copy of length bytes. NULL when out of memory. */
char *orl_arena_text(struct orl_arena *arena, const char *text, size_t length);

#endif
