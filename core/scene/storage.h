/*
 * Storage: memory that is handed out piece by piece and given back all at once. A scene has
 * millions of names and vertex lists that live and die together; one call to the allocator for each
 * would cost more than parsing them.
 *
 * Ownership: what orl_storage_take returns belongs to the storage. Threads: one at a time.
 */
#ifndef ORL_SCENE_STORAGE_H
#define ORL_SCENE_STORAGE_H

#include <stddef.h>

struct orl_storage;

struct orl_storage *orl_storage_new(void);          /* NULL when out of memory */
void orl_storage_free(struct orl_storage *storage); /* NULL is allowed */

/* size bytes, aligned for any type, not cleared. NULL when out of memory. */
void *orl_storage_take(struct orl_storage *storage, size_t size);

/* A NUL-terminated copy of length bytes. NULL when out of memory. */
char *orl_storage_text(struct orl_storage *storage, const char *text, size_t length);

#endif
