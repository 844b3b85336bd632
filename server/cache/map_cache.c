#include "cache/map_cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cache/map_entries.h"
#include "process/times.h"

void orl_map_path(const struct orl_map_cache *cache, const char *kind, const char *key,
                  char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(cache->folders, ret_path, "maps/%s-%s.opm", kind, key);
}

struct orl_map_entry *orl_map_find(struct orl_map_cache *cache, const char *kind, const char *key)
{
    struct orl_map_entry *entry = cache->entries;
    while (entry &&
           (strcmp(entry->map.info.kind, kind) != 0 || strcmp(entry->map.info.key, key) != 0))
        entry = entry->next;
    return entry;
}

struct orl_map_entry *orl_map_add(struct orl_map_cache *cache, const char *kind, const char *key)
{
    struct orl_map_entry *entry = orl_map_find(cache, kind, key);
    if (entry)
        return entry;
    entry = calloc(1, sizeof *entry);
    if (!entry)
        return NULL;
    snprintf(entry->map.info.kind, sizeof entry->map.info.kind, "%s", kind);
    snprintf(entry->map.info.key, sizeof entry->map.info.key, "%s", key);
    entry->next = cache->entries;
    cache->entries = entry;
    return entry;
}

/* ---- The store, called by workers ----------------------------------------------------------- */

/* Waits up to 50 ms for an entry to change. The wait is short because the cancel flag does not
 * signal the condition variable. */
static void wait_for_change(struct orl_map_cache *cache)
{
    enum { MOMENT_NS = 50 * 1000 * 1000 };
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += MOMENT_NS;
    if (until.tv_nsec >= 1000000000) {
        until.tv_nsec -= 1000000000;
        until.tv_sec++;
    }
    pthread_cond_timedwait(&cache->changed, &cache->mutex, &until);
}

static void record_hit(struct orl_map_cache *cache, struct orl_map_entry *entry)
{
    cache->hits++;
    entry->pins++;
    entry->map.hits++;
    entry->map.seconds_saved += entry->map.info.seconds;
    entry->map.last_used_ms = orl_time_now_ms();
    entry->dirty = true;
}

/* Returns true if the map is ready and its file readable. A file that was deleted by hand is built
 * again. */
static bool is_ready(const struct orl_map_cache *cache, const struct orl_map_entry *entry)
{
    char path[ORL_PATH_MAX];
    orl_map_path(cache, entry->map.info.kind, entry->map.info.key, path);
    return entry->state == ORL_MAP_IS_READY && access(path, R_OK) == 0;
}

static int cache_acquire(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                         char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                         struct orl_error *err)
{
    struct orl_map_cache *cache = ctx;
    int rc = 0;
    bool hit = false;
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = orl_map_add(cache, kind, key);
    if (!entry)
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    while (rc == 0 &&
           (entry->state == ORL_MAP_IS_BUILDING || entry->state == ORL_MAP_IS_BEING_REMOVED)) {
        if (cancel && atomic_load(cancel)) {
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while another job built the map");
            break;
        }
        wait_for_change(cache);
        entry = orl_map_add(cache, kind, key);
        if (!entry)
            rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (rc == 0 && is_ready(cache, entry)) {
        hit = true;
        record_hit(cache, entry);
        *ret_info = entry->map.info;
        ret_info->cached = true;
        orl_map_path(cache, kind, key, ret_path);
    } else if (rc == 0) {
        entry->state = ORL_MAP_IS_BUILDING;
        cache->misses++;
        orl_folders_temporary(cache->folders, entry->building);
        memcpy(ret_path, entry->building, ORL_PATH_MAX);
    }
    pthread_mutex_unlock(&cache->mutex);
    if (rc == 0)
        *ret_hit = hit;
    if (hit)
        cache->wake(cache->wake_ctx);
    return rc;
}

static void cache_abandon(void *ctx, const char *kind, const char *key)
{
    struct orl_map_cache *cache = ctx;
    char path[ORL_PATH_MAX];
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = orl_map_find(cache, kind, key);
    if (entry && entry->state == ORL_MAP_IS_BUILDING) {
        unlink(entry->building);
        entry->state = ORL_MAP_IS_ABSENT;
    } else if (entry && entry->state == ORL_MAP_IS_READY) {
        /* The file is damaged. Jobs that have it mapped keep their pages; new jobs do not get it.
         */
        orl_map_path(cache, kind, key, path);
        unlink(path);
        entry->state = ORL_MAP_IS_ABSENT;
        entry->dirty = true;
        entry->pins -= entry->pins > 0;
    }
    pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->mutex);
    cache->wake(cache->wake_ctx);
}

static int cache_commit(void *ctx, const struct orl_map_info *info, struct orl_error *err)
{
    struct orl_map_cache *cache = ctx;
    char path[ORL_PATH_MAX], building[ORL_PATH_MAX];
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = orl_map_find(cache, info->kind, info->key);
    const bool ours = entry && entry->state == ORL_MAP_IS_BUILDING;
    if (ours)
        memcpy(building, entry->building, sizeof building);
    pthread_mutex_unlock(&cache->mutex);
    if (!ours)
        return orl_error_set(err, ORL_ERR_INTERNAL, "a map was committed that nobody built");
    /* Only the builder may touch a building entry, so the slow disk work needs no lock. */
    orl_map_path(cache, info->kind, info->key, path);
    int rc = orl_sync_path(building, err);
    if (rc == 0)
        rc = orl_rename_synced(building, path, err);
    if (rc) {
        /* Gives up the build here; otherwise jobs would wait for it forever. */
        cache_abandon(cache, info->kind, info->key);
        return rc;
    }
    pthread_mutex_lock(&cache->mutex);
    entry->map = (struct orl_stored_map){.info = *info, .created_ms = orl_time_now_ms()};
    entry->map.info.cached = false;
    entry->map.last_used_ms = entry->map.created_ms;
    entry->state = ORL_MAP_IS_READY;
    entry->pins++;
    entry->dirty = true;
    pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->mutex);
    cache->wake(cache->wake_ctx);
    return 0;
}

static void cache_release(void *ctx, const char *kind, const char *key)
{
    struct orl_map_cache *cache = ctx;
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = orl_map_find(cache, kind, key);
    if (entry && entry->pins > 0) {
        entry->pins--;
        entry->map.last_used_ms = orl_time_now_ms();
        entry->dirty = true;
    }
    pthread_mutex_unlock(&cache->mutex);
    cache->wake(cache->wake_ctx); /* the map can be removed now, which may free disk space */
}

static int cache_find_smaller(void *ctx, const char *kind, const char *family, uint64_t target,
                              char ret_path[4096], bool *ret_found, struct orl_map_info *ret_info,
                              struct orl_error *err)
{
    struct orl_map_cache *cache = ctx;
    struct orl_map_entry *best = NULL;
    (void)err;
    pthread_mutex_lock(&cache->mutex);
    for (struct orl_map_entry *entry = cache->entries; entry; entry = entry->next) {
        const struct orl_map_info *info = &entry->map.info;
        if (info->target < target && (!best || info->target > best->map.info.target) &&
            strcmp(info->kind, kind) == 0 && strcmp(info->family, family) == 0 &&
            is_ready(cache, entry))
            best = entry;
    }
    if (best) {
        record_hit(cache, best);
        *ret_info = best->map.info;
        orl_map_path(cache, kind, ret_info->key, ret_path);
    }
    pthread_mutex_unlock(&cache->mutex);
    *ret_found = best != NULL;
    if (best)
        cache->wake(cache->wake_ctx);
    return 0;
}

struct orl_map_store orl_map_cache_store(struct orl_map_cache *cache)
{
    return (struct orl_map_store){.ctx = cache,
                                  .acquire = cache_acquire,
                                  .commit = cache_commit,
                                  .abandon = cache_abandon,
                                  .release = cache_release,
                                  .find_smaller = cache_find_smaller};
}
