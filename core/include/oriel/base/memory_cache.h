/*
 * In-memory cache of data that jobs derive from scenes and maps, for later jobs, up to a number of
 * bytes. The oldest entry is dropped first. Entries can be computed again with the same result at
 * any time: results do not depend on the cache.
 *
 * A scene is shared by all jobs that use it at the same time. Any other entry has one user: taking
 * it removes it from the cache, and the job puts it back afterwards.
 *
 * Locks: one mutex inside. Any thread may take and put.
 */
#ifndef ORIEL_BASE_MEMORY_CACHE_H
#define ORIEL_BASE_MEMORY_CACHE_H

#include <stdint.h>

struct orl_memory_cache;

/* Creates a cache. With 0 bytes it never holds an entry. NULL when out of memory. */
struct orl_memory_cache *orl_memory_cache_new(uint64_t most_bytes);
/* Frees the cache and all its entries. NULL is allowed. */
void orl_memory_cache_free(struct orl_memory_cache *memory_cache);

struct orl_memory_cache_totals {
    uint64_t bytes, things; /* current sizes */
    uint64_t shared;        /* scenes among these entries, which several jobs may use at once */
    uint64_t hits;          /* successful look-ups since the cache was created */
    uint64_t shared_hits;   /* hits that were scenes */
};

/* Returns the totals; zeros for a NULL cache. */
struct orl_memory_cache_totals orl_memory_cache_totals(struct orl_memory_cache *memory_cache);

/* ---- Entries --------------------------------------------------------------------------------- */

enum { ORL_MEMORY_CACHE_KEY = 256 }; /* size of a key's buffer */

/* Removes the entry under that key and passes it to the caller; NULL if there is none, or no
 * cache. */
void *orl_memory_cache_take(struct orl_memory_cache *memory_cache, const char *key);

/*
 * Stores the thing and takes ownership; release destroys it. An existing entry of that key is
 * destroyed. The thing itself is destroyed if it exceeds the cache's capacity, or there is no
 * cache.
 */
void orl_memory_cache_put(struct orl_memory_cache *memory_cache, const char *key, void *thing,
                          uint64_t bytes, void (*release)(void *thing));

/* Reference counting of a shared thing; every user and the cache hold a reference. */
struct orl_reference_calls {
    void *(*add_reference)(void *thing); /* adds a reference; called with the cache locked, so it
                                   must do nothing else */
    void (*release)(void *thing);
};

/* Returns a reference to the entry under that key, which stays in the cache; or NULL. */
void *orl_memory_cache_get_shared(struct orl_memory_cache *memory_cache, const char *key,
                                  const struct orl_reference_calls *sharing);

/*
 * Stores a shared thing; the caller keeps its reference. If the key has an entry by now, the
 * caller's reference is dropped, and a reference to that entry is returned.
 */
void *orl_memory_cache_put_shared(struct orl_memory_cache *memory_cache, const char *key,
                                  void *thing, uint64_t bytes,
                                  const struct orl_reference_calls *sharing);

#endif
