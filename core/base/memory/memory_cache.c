#include <oriel/base/memory_cache.h>

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct cache_entry {
    struct cache_entry *next; /* next older entry */
    char key[ORL_MEMORY_CACHE_KEY];
    void *thing;
    uint64_t bytes;
    bool shared;
    void (*release)(void *thing);
};

struct orl_memory_cache {
    pthread_mutex_t mutex;
    struct cache_entry *latest;
    struct orl_memory_cache_totals totals;
    uint64_t most; /* bytes */
};

struct orl_memory_cache *orl_memory_cache_new(uint64_t most_bytes)
{
    struct orl_memory_cache *memory_cache = calloc(1, sizeof *memory_cache);
    if (!memory_cache)
        return NULL;
    pthread_mutex_init(&memory_cache->mutex, NULL);
    memory_cache->most = most_bytes;
    return memory_cache;
}

/* Frees a list of entries and their contents. */
static void free_entries(struct cache_entry *entries)
{
    while (entries) {
        struct cache_entry *next = entries->next;
        entries->release(entries->thing);
        free(entries);
        entries = next;
    }
}

void orl_memory_cache_free(struct orl_memory_cache *memory_cache)
{
    if (!memory_cache)
        return;
    free_entries(memory_cache->latest);
    pthread_mutex_destroy(&memory_cache->mutex);
    free(memory_cache);
}

struct orl_memory_cache_totals orl_memory_cache_totals(struct orl_memory_cache *memory_cache)
{
    struct orl_memory_cache_totals totals = {0};
    if (!memory_cache)
        return totals;
    pthread_mutex_lock(&memory_cache->mutex);
    totals = memory_cache->totals;
    pthread_mutex_unlock(&memory_cache->mutex);
    return totals;
}

/* Removes the entry under that key from the list; the mutex is held. */
static struct cache_entry *unlink_entry(struct orl_memory_cache *memory_cache, const char *key)
{
    for (struct cache_entry **at = &memory_cache->latest; *at; at = &(*at)->next) {
        struct cache_entry *cache_entry = *at;
        if (strcmp(cache_entry->key, key) != 0)
            continue;
        *at = cache_entry->next;
        cache_entry->next = NULL;
        memory_cache->totals.bytes -= cache_entry->bytes;
        memory_cache->totals.things--;
        memory_cache->totals.shared -= cache_entry->shared;
        return cache_entry;
    }
    return NULL;
}

/* Removes the oldest entries beyond the capacity from the list, and returns them; the mutex is
 * held. */
static struct cache_entry *unlink_oldest(struct orl_memory_cache *memory_cache)
{
    uint64_t bytes = 0, things = 0, shared = 0;
    struct cache_entry **at = &memory_cache->latest;
    while (*at && bytes + (*at)->bytes <= memory_cache->most) {
        bytes += (*at)->bytes;
        things++;
        shared += (*at)->shared;
        at = &(*at)->next;
    }
    struct cache_entry *rest = *at;
    *at = NULL;
    memory_cache->totals.bytes = bytes;
    memory_cache->totals.things = things;
    memory_cache->totals.shared = shared;
    return rest;
}

void *orl_memory_cache_take(struct orl_memory_cache *memory_cache, const char *key)
{
    if (!memory_cache)
        return NULL;
    pthread_mutex_lock(&memory_cache->mutex);
    struct cache_entry *cache_entry = unlink_entry(memory_cache, key);
    memory_cache->totals.hits += cache_entry != NULL;
    pthread_mutex_unlock(&memory_cache->mutex);
    void *thing = cache_entry ? cache_entry->thing : NULL;
    free(cache_entry);
    return thing;
}

/* Creates an entry. NULL: it is too large, or there is no cache or no memory. */
static struct cache_entry *entry_for(const struct orl_memory_cache *memory_cache, const char *key,
                                     void *thing, uint64_t bytes, void (*release)(void *thing))
{
    struct cache_entry *cache_entry =
        memory_cache && bytes <= memory_cache->most && strlen(key) < ORL_MEMORY_CACHE_KEY
            ? malloc(sizeof *cache_entry)
            : NULL;
    if (!cache_entry)
        return NULL;
    *cache_entry = (struct cache_entry){.thing = thing, .bytes = bytes, .release = release};
    memcpy(cache_entry->key, key, strlen(key) + 1);
    return cache_entry;
}

static void link_entry(struct orl_memory_cache *memory_cache, struct cache_entry *cache_entry)
{
    cache_entry->next = memory_cache->latest;
    memory_cache->latest = cache_entry;
}

void orl_memory_cache_put(struct orl_memory_cache *memory_cache, const char *key, void *thing,
                          uint64_t bytes, void (*release)(void *thing))
{
    struct cache_entry *cache_entry = entry_for(memory_cache, key, thing, bytes, release);
    if (!cache_entry) {
        release(thing);
        return;
    }
    pthread_mutex_lock(&memory_cache->mutex);
    struct cache_entry *same = unlink_entry(memory_cache, key);
    link_entry(memory_cache, cache_entry);
    struct cache_entry *rest = unlink_oldest(memory_cache);
    pthread_mutex_unlock(&memory_cache->mutex);
    free_entries(same);
    free_entries(rest);
}

/* Adds a reference for the caller and moves the entry to the front; the mutex is held. */
static void *reference_entry(struct orl_memory_cache *memory_cache, const char *key,
                             const struct orl_reference_calls *sharing)
{
    struct cache_entry *cache_entry = unlink_entry(memory_cache, key);
    if (!cache_entry)
        return NULL;
    link_entry(memory_cache, cache_entry);
    memory_cache->totals.bytes += cache_entry->bytes;
    memory_cache->totals.things++;
    memory_cache->totals.shared++;
    return sharing->add_reference(cache_entry->thing);
}

void *orl_memory_cache_get_shared(struct orl_memory_cache *memory_cache, const char *key,
                                  const struct orl_reference_calls *sharing)
{
    if (!memory_cache)
        return NULL;
    pthread_mutex_lock(&memory_cache->mutex);
    void *thing = reference_entry(memory_cache, key, sharing);
    memory_cache->totals.hits += thing != NULL;
    memory_cache->totals.shared_hits += thing != NULL;
    pthread_mutex_unlock(&memory_cache->mutex);
    return thing;
}

void *orl_memory_cache_put_shared(struct orl_memory_cache *memory_cache, const char *key,
                                  void *thing, uint64_t bytes,
                                  const struct orl_reference_calls *sharing)
{
    struct cache_entry *cache_entry = entry_for(memory_cache, key, thing, bytes, sharing->release),
                       *rest = NULL;
    if (!cache_entry)
        return thing;
    cache_entry->shared = true;
    pthread_mutex_lock(&memory_cache->mutex);
    void *same = reference_entry(memory_cache, key, sharing);
    if (!same) {
        sharing->add_reference(thing);
        link_entry(memory_cache, cache_entry);
        rest = unlink_oldest(memory_cache);
    }
    pthread_mutex_unlock(&memory_cache->mutex);
    free_entries(rest);
    if (!same)
        return thing;
    free(cache_entry);
    sharing->release(thing);
    return same;
}
