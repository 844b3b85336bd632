/* Access to the in-memory cache (oriel/base/memory_cache.h). */
#ifndef ORL_BASE_MEMORY_MEMORY_CACHE_H
#define ORL_BASE_MEMORY_MEMORY_CACHE_H

#include <oriel/base/memory_cache.h>

enum { ORL_MEMORY_CACHE_KEY = 256 }; /* size of a key's buffer */

/* Removes the entry under that key and passes it to the caller; NULL if there is none, or no
 * shelf. */
void *orl_memory_cache_take(struct orl_memory_cache *memory_cache, const char *key);

/*
 * Stores the thing and takes ownership; let_go destroys it. An existing entry of that key is
 * destroyed. The thing itself is destroyed if it exceeds the shelf's capacity, or there is no
 * shelf.
 */
void orl_memory_cache_put(struct orl_memory_cache *memory_cache, const char *key, void *thing,
                          uint64_t bytes, void (*release)(void *thing));

/* Reference counting of a shared thing; every user and the shelf hold a reference. */
struct orl_reference_calls {
    void *(*add_reference)(void *thing); /* adds a reference; called with the shelf locked, so it
                                   must do nothing else */
    void (*release)(void *thing);
};

/* Returns a reference to the entry under that key, which stays on the shelf; or NULL. */
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
