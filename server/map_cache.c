#include "map_cache.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "discard.h"
#include "times.h"

enum entry_state { ENTRY_ABSENT, ENTRY_BUILDING, ENTRY_READY, ENTRY_LEAVING };

struct entry {
    struct orl_stored_map map;
    enum entry_state state;
    unsigned pins;
    bool dirty; /* the row differs from this */
    char building[ORL_PATH_MAX];
    struct entry *next;
};

struct orl_map_cache {
    uv_loop_t *loop;
    const struct orl_folders *folders;
    struct orl_db *db;
    orl_map_cache_wake wake;
    void *wake_ctx;
    pthread_mutex_t mutex;
    pthread_cond_t changed; /* an entry left BUILDING */
    struct entry *entries;
    uint64_t hits, misses;
};

static void final_path(const struct orl_map_cache *cache, const char *kind, const char *key,
                       char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(cache->folders, ret_path, "maps/%s-%s.opm", kind, key);
}

static struct entry *find_entry(struct orl_map_cache *cache, const char *kind, const char *key)
{
    struct entry *entry = cache->entries;
    while (entry &&
           (strcmp(entry->map.info.kind, kind) != 0 || strcmp(entry->map.info.key, key) != 0))
        entry = entry->next;
    return entry;
}

static struct entry *find_or_add(struct orl_map_cache *cache, const char *kind, const char *key)
{
    struct entry *entry = find_entry(cache, kind, key);
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

/* Is it of no more use? Nobody holds it, and the row is as it should be. */
static bool is_spent(const struct entry *entry)
{
    return entry->state == ENTRY_ABSENT && entry->pins == 0 && !entry->dirty;
}

/* Those who wait look their entry up again, so that it may go. */
static void drop_spent(struct orl_map_cache *cache)
{
    for (struct entry **at = &cache->entries; *at;) {
        struct entry *entry = *at;
        if (!is_spent(entry)) {
            at = &entry->next;
            continue;
        }
        *at = entry->next;
        free(entry);
    }
}

/* ---- The store, called by workers ----------------------------------------------------------- */

/* Waits a moment for an entry to change; short, because the cancel flag has no condition. */
static void wait_a_moment(struct orl_map_cache *cache)
{
    enum { MOMENT_NS = 50 * 1000 * 1000 };
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += MOMENT_NS;
    if (until.tv_nsec >= 1000000000) {
        until.tv_nsec -= 1000000000;
        until.tv_sec++;
    }
    pthread_cond_timedwait(&cache->changed, &cache->mutex, &until);
}

static void note_hit(struct orl_map_cache *cache, struct entry *entry)
{
    cache->hits++;
    entry->pins++;
    entry->map.hits++;
    entry->map.seconds_saved += entry->map.info.seconds;
    entry->map.last_used_ms = orl_time_now_ms();
    entry->dirty = true;
}

/* A file that someone removed, to make room perhaps, is built again rather than missed for ever. */
static bool is_ready(const struct orl_map_cache *cache, const struct entry *entry)
{
    char path[ORL_PATH_MAX];
    final_path(cache, entry->map.info.kind, entry->map.info.key, path);
    return entry->state == ENTRY_READY && access(path, R_OK) == 0;
}

static int cache_acquire(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                         char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                         struct orl_error *err)
{
    struct orl_map_cache *cache = ctx;
    int rc = 0;
    bool hit = false;
    pthread_mutex_lock(&cache->mutex);
    struct entry *entry = find_or_add(cache, kind, key);
    if (!entry)
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    while (rc == 0 && (entry->state == ENTRY_BUILDING || entry->state == ENTRY_LEAVING)) {
        if (cancel && atomic_load(cancel)) {
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while another job built the map");
            break;
        }
        wait_a_moment(cache);
        entry = find_or_add(cache, kind, key);
        if (!entry)
            rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (rc == 0 && is_ready(cache, entry)) {
        hit = true;
        note_hit(cache, entry);
        *ret_info = entry->map.info;
        ret_info->cached = true;
        final_path(cache, kind, key, ret_path);
    } else if (rc == 0) {
        entry->state = ENTRY_BUILDING;
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
    struct entry *entry = find_entry(cache, kind, key);
    if (entry && entry->state == ENTRY_BUILDING) {
        unlink(entry->building);
        entry->state = ENTRY_ABSENT;
    } else if (entry && entry->state == ENTRY_READY) {
        /* A damaged file. Jobs that have it mapped keep their pages; nobody new gets it. */
        final_path(cache, kind, key, path);
        unlink(path);
        entry->state = ENTRY_ABSENT;
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
    struct entry *entry = find_entry(cache, info->kind, info->key);
    const bool ours = entry && entry->state == ENTRY_BUILDING;
    if (ours)
        memcpy(building, entry->building, sizeof building);
    pthread_mutex_unlock(&cache->mutex);
    if (!ours)
        return orl_error_set(err, ORL_ERR_INTERNAL, "a map was committed that nobody built");
    /* Only the builder may touch a building entry, so the disk can be slow without the lock. */
    final_path(cache, info->kind, info->key, path);
    int rc = orl_sync_path(building, err);
    if (rc == 0)
        rc = orl_rename_synced(building, path, err);
    if (rc) {
        /* Given up here, lest those who wait for this build wait for ever. */
        cache_abandon(cache, info->kind, info->key);
        return rc;
    }
    pthread_mutex_lock(&cache->mutex);
    entry->map = (struct orl_stored_map){.info = *info, .created_ms = orl_time_now_ms()};
    entry->map.info.cached = false;
    entry->map.last_used_ms = entry->map.created_ms;
    entry->state = ENTRY_READY;
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
    struct entry *entry = find_entry(cache, kind, key);
    if (entry && entry->pins > 0) {
        entry->pins--;
        entry->map.last_used_ms = orl_time_now_ms();
        entry->dirty = true;
    }
    pthread_mutex_unlock(&cache->mutex);
    cache->wake(cache->wake_ctx); /* there may be somebody to whom it makes room */
}

static int cache_find_smaller(void *ctx, const char *kind, const char *family, uint64_t target,
                              char ret_path[4096], bool *ret_found, struct orl_map_info *ret_info,
                              struct orl_error *err)
{
    struct orl_map_cache *cache = ctx;
    struct entry *best = NULL;
    (void)err;
    pthread_mutex_lock(&cache->mutex);
    for (struct entry *entry = cache->entries; entry; entry = entry->next) {
        const struct orl_map_info *info = &entry->map.info;
        if (info->target < target && (!best || info->target > best->map.info.target) &&
            strcmp(info->kind, kind) == 0 && strcmp(info->family, family) == 0 &&
            is_ready(cache, entry))
            best = entry;
    }
    if (best) {
        note_hit(cache, best);
        *ret_info = best->map.info;
        final_path(cache, kind, ret_info->key, ret_path);
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

/* ---- The loop thread's side ----------------------------------------------------------------- */

int orl_map_cache_flush(struct orl_map_cache *cache, struct orl_error *err)
{
    int rc = 0;
    for (;;) {
        /* One at a time: the database is slow and the mutex is the workers'. */
        struct orl_stored_map map;
        bool ready = false;
        pthread_mutex_lock(&cache->mutex);
        struct entry *entry = cache->entries;
        while (entry && !entry->dirty)
            entry = entry->next;
        if (entry) {
            map = entry->map;
            ready = entry->state == ENTRY_READY;
            entry->dirty = false;
        } else {
            drop_spent(cache);
        }
        pthread_mutex_unlock(&cache->mutex);
        if (!entry)
            return rc;
        const int one = ready ? orl_map_row_put(cache->db, &map, err)
                              : orl_map_row_drop(cache->db, map.info.kind, map.info.key, err);
        rc = rc ? rc : one;
    }
}

void orl_map_cache_totals(struct orl_map_cache *cache, struct orl_map_cache_totals *ret_totals)
{
    pthread_mutex_lock(&cache->mutex);
    *ret_totals = (struct orl_map_cache_totals){.hits = cache->hits, .misses = cache->misses};
    for (const struct entry *entry = cache->entries; entry; entry = entry->next) {
        if (entry->state != ENTRY_READY)
            continue;
        ret_totals->entries++;
        ret_totals->bytes += entry->map.info.bytes;
        if (strcmp(entry->map.info.kind, "bsdf") == 0)
            ret_totals->bsdf_bytes += entry->map.info.bytes;
    }
    pthread_mutex_unlock(&cache->mutex);
}

static int by_last_use(const void *a, const void *b)
{
    const struct orl_stored_map *x = a, *y = b;
    if (x->last_used_ms != y->last_used_ms)
        return x->last_used_ms < y->last_used_ms ? 1 : -1;
    return strcmp(x->info.key, y->info.key);
}

int orl_map_cache_list(struct orl_map_cache *cache, struct orl_stored_map **ret_maps,
                       size_t *ret_count, struct orl_error *err)
{
    size_t count = 0, filled = 0;
    pthread_mutex_lock(&cache->mutex);
    for (struct entry *entry = cache->entries; entry; entry = entry->next)
        count += entry->state == ENTRY_READY;
    struct orl_stored_map *maps = calloc(count ? count : 1, sizeof *maps);
    for (struct entry *entry = cache->entries; entry && maps; entry = entry->next)
        if (entry->state == ENTRY_READY) {
            maps[filled] = entry->map;
            maps[filled++].in_use = entry->pins > 0;
        }
    pthread_mutex_unlock(&cache->mutex);
    if (!maps)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    qsort(maps, count, sizeof *maps, by_last_use);
    *ret_maps = maps;
    *ret_count = count;
    return 0;
}

/* Takes a ready entry that nobody uses out of reach, until its row is gone. */
static enum orl_map_removal begin_removal(struct orl_map_cache *cache, const char *kind,
                                          const char *key)
{
    enum orl_map_removal found = ORL_MAP_ABSENT;
    pthread_mutex_lock(&cache->mutex);
    struct entry *entry = find_entry(cache, kind, key);
    if (entry && (entry->state == ENTRY_BUILDING || entry->pins > 0)) {
        found = ORL_MAP_IN_USE;
    } else if (entry && entry->state == ENTRY_READY) {
        found = ORL_MAP_REMOVED;
        entry->state = ENTRY_LEAVING;
    }
    pthread_mutex_unlock(&cache->mutex);
    return found;
}

static void end_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                        enum entry_state state)
{
    pthread_mutex_lock(&cache->mutex);
    struct entry *entry = find_entry(cache, kind, key);
    entry->state = state;
    entry->dirty = entry->dirty && state == ENTRY_READY;
    drop_spent(cache);
    pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->mutex);
}

int orl_map_cache_remove(struct orl_map_cache *cache, const char *kind, const char *key,
                         enum orl_map_removal *ret_removal, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    *ret_removal = begin_removal(cache, kind, key);
    if (*ret_removal != ORL_MAP_REMOVED)
        return 0;
    const int rc = orl_map_row_drop(cache->db, kind, key, err);
    final_path(cache, kind, key, path);
    if (rc == 0)
        orl_discard(cache->loop, cache->folders, path);
    end_removal(cache, kind, key, rc ? ENTRY_READY : ENTRY_ABSENT);
    return rc;
}

/* A row at start: kept when its file is there at its length, dropped otherwise. */
static int load_row(void *ctx, const struct orl_stored_map *map)
{
    struct orl_map_cache *cache = ctx;
    char path[ORL_PATH_MAX];
    struct entry *entry = find_or_add(cache, map->info.kind, map->info.key);
    if (!entry)
        return ORL_ERR_NOMEM;
    final_path(cache, map->info.kind, map->info.key, path);
    const bool there = access(path, R_OK) == 0;
    entry->map = *map;
    entry->state = there ? ENTRY_READY : ENTRY_ABSENT;
    entry->dirty = !there;
    return 0;
}

/* Files that no row speaks of were committed a moment before a crash. */
static int remove_orphans(struct orl_map_cache *cache, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(cache->folders, path, "maps");
    DIR *folder = opendir(path);
    if (!folder)
        return orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", path, strerror(errno));
    for (const struct dirent *file; (file = readdir(folder));) {
        char kind[16], key[ORL_DIGEST_HEX + 1];
        if (file->d_name[0] == '.')
            continue;
        const struct entry *entry = NULL;
        if (sscanf(file->d_name, "%15[a-z]-%64[0-9a-f].opm", kind, key) == 2)
            entry = find_entry(cache, kind, key);
        if (!entry || entry->state != ENTRY_READY) {
            orl_folders_path(cache->folders, path, "maps/%s", file->d_name);
            unlink(path);
        }
    }
    closedir(folder);
    return 0;
}

int orl_map_cache_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                       orl_map_cache_wake wake, void *wake_ctx, struct orl_map_cache **ret_cache,
                       struct orl_error *err)
{
    struct orl_map_cache *cache = calloc(1, sizeof *cache);
    if (!cache)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    *cache = (struct orl_map_cache){
        .loop = loop, .folders = folders, .db = db, .wake = wake, .wake_ctx = wake_ctx};
    pthread_mutex_init(&cache->mutex, NULL);
    pthread_cond_init(&cache->changed, NULL);
    int rc = orl_map_rows(db, load_row, cache, err);
    if (rc == 0)
        rc = remove_orphans(cache, err);
    if (rc == 0)
        rc = orl_map_cache_flush(cache, err);
    if (rc)
        orl_map_cache_close(cache);
    else
        *ret_cache = cache;
    return rc;
}

void orl_map_cache_close(struct orl_map_cache *cache)
{
    if (!cache)
        return;
    while (cache->entries) {
        struct entry *entry = cache->entries;
        cache->entries = entry->next;
        free(entry);
    }
    pthread_cond_destroy(&cache->changed);
    pthread_mutex_destroy(&cache->mutex);
    free(cache);
}
