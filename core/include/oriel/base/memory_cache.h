/*
 * In-memory cache of data that jobs derive from scenes and maps, for later jobs, up to a number of
 * bytes. The oldest entry is dropped first. Entries can be computed again with the same result at
 * any time: results do not depend on the cache.
 *
 * A scene is shared by all jobs that use it at the same time. Any other entry has one user: taking
 * it removes it from the shelf, and the job puts it back afterwards.
 *
 * Locks: one mutex inside. Any thread may take and put.
 */
#ifndef ORIEL_BASE_MEMORY_CACHE_H
#define ORIEL_BASE_MEMORY_CACHE_H

#include <stdint.h>

struct orl_memory_cache;

/* Creates a shelf. With 0 bytes it never holds an entry. NULL when out of memory. */
struct orl_memory_cache *orl_memory_cache_new(uint64_t most_bytes);
/* Frees the shelf and all its entries. NULL is allowed. */
void orl_memory_cache_free(struct orl_memory_cache *memory_cache);

struct orl_memory_cache_totals {
    uint64_t bytes, things; /* current sizes */
    uint64_t shared;        /* scenes among these entries, which several jobs may use at once */
    uint64_t hits;          /* successful look-ups since the shelf was created */
    uint64_t shared_hits;   /* hits that were scenes */
};

/* Returns the totals; zeros for a NULL shelf. */
struct orl_memory_cache_totals orl_memory_cache_totals(struct orl_memory_cache *memory_cache);

#endif
