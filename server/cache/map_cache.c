#include "cache/map_cache.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "process/times.h"
#include "store/files/removal.h"

/* Workers call the store's functions, and the loop thread calls all others. Callers of the static
 * functions hold the mutex unless a comment says otherwise. */

/* BEING_REMOVED: no longer ready, though its row and file may still exist. */
enum orl_map_state {
    ORL_MAP_IS_ABSENT,
    ORL_MAP_IS_BUILDING,
    ORL_MAP_IS_READY,
    ORL_MAP_IS_BEING_REMOVED
};

struct orl_map_entry {
    struct orl_stored_map map;
    enum orl_map_state state;
    unsigned pins;
    bool dirty; /* true if the database row differs from this entry */
    char building[ORL_PATH_MAX];
    struct orl_map_entry *next;
};

struct orl_map_cache {
    uv_loop_t *loop;
    const struct orl_folders *folders;
    struct orl_db *db;
    orl_map_cache_wake wake;
    void *wake_ctx;
    pthread_mutex_t mutex;
    pthread_cond_t changed; /* signalled when an entry leaves BUILDING */
    struct orl_map_entry *entries;
    uint64_t hits, misses;
};

/* Writes the path of the map's file. Needs no mutex. */
static void map_path(const struct orl_map_cache *cache, const char *kind, const char *key,
                     char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(cache->folders, ret_path, "maps/%s-%s.opm", kind, key);
}

/* Returns NULL if there is no entry. */
static struct orl_map_entry *find_entry(struct orl_map_cache *cache, const char *kind,
                                        const char *key)
{
    struct orl_map_entry *entry = cache->entries;
    while (entry &&
           (strcmp(entry->map.info.kind, kind) != 0 || strcmp(entry->map.info.key, key) != 0))
        entry = entry->next;
    return entry;
}

/* Returns the entry, which is added if it is missing. NULL when out of memory. */
static struct orl_map_entry *add_entry(struct orl_map_cache *cache, const char *kind,
                                       const char *key)
{
    struct orl_map_entry *entry = find_entry(cache, kind, key);
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
    map_path(cache, entry->map.info.kind, entry->map.info.key, path);
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
    struct orl_map_entry *entry = add_entry(cache, kind, key);
    if (!entry)
        rc = orl_error_no_memory(err);
    while (rc == 0 &&
           (entry->state == ORL_MAP_IS_BUILDING || entry->state == ORL_MAP_IS_BEING_REMOVED)) {
        if (cancel && atomic_load(cancel)) {
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while another job built the map");
            break;
        }
        wait_for_change(cache);
        entry = add_entry(cache, kind, key);
        if (!entry)
            rc = orl_error_no_memory(err);
    }
    if (rc == 0 && is_ready(cache, entry)) {
        hit = true;
        record_hit(cache, entry);
        *ret_info = entry->map.info;
        ret_info->cached = true;
        map_path(cache, kind, key, ret_path);
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
    struct orl_map_entry *entry = find_entry(cache, kind, key);
    if (entry && entry->state == ORL_MAP_IS_BUILDING) {
        unlink(entry->building);
        entry->state = ORL_MAP_IS_ABSENT;
    } else if (entry && entry->state == ORL_MAP_IS_READY) {
        /* The file is damaged. Jobs that have it mapped keep their pages; new jobs do not get it.
         */
        map_path(cache, kind, key, path);
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
    struct orl_map_entry *entry = find_entry(cache, info->kind, info->key);
    const bool ours = entry && entry->state == ORL_MAP_IS_BUILDING;
    if (ours)
        memcpy(building, entry->building, sizeof building);
    pthread_mutex_unlock(&cache->mutex);
    if (!ours)
        return orl_error_set(err, ORL_ERR_INTERNAL, "a map was committed that no job is building");
    /* Only the builder may touch a building entry, so the slow disk work needs no lock. */
    map_path(cache, info->kind, info->key, path);
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
    struct orl_map_entry *entry = find_entry(cache, kind, key);
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
        map_path(cache, kind, ret_info->key, ret_path);
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

/* Returns true if the entry can be freed: its map is absent and unpinned, its row up to date. */
static bool is_spent(const struct orl_map_entry *entry)
{
    return entry->state == ORL_MAP_IS_ABSENT && entry->pins == 0 && !entry->dirty;
}

/* Frees spent entries. Waiting jobs look their entry up again, so they hold no pointer to it. */
static void drop_spent(struct orl_map_cache *cache)
{
    for (struct orl_map_entry **at = &cache->entries; *at;) {
        struct orl_map_entry *entry = *at;
        if (!is_spent(entry)) {
            at = &entry->next;
            continue;
        }
        *at = entry->next;
        free(entry);
    }
}

/* Copies the next entry whose row must be written, since the database is too slow to hold the
 * workers' mutex meanwhile. Returns false if there is none. */
static bool copy_dirty_row(struct orl_map_cache *cache, struct orl_stored_map *ret_map,
                           bool *ret_ready)
{
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = cache->entries;
    while (entry && !entry->dirty)
        entry = entry->next;
    if (entry) {
        *ret_map = entry->map;
        *ret_ready = entry->state == ORL_MAP_IS_READY;
        entry->dirty = false;
    } else {
        drop_spent(cache);
    }
    pthread_mutex_unlock(&cache->mutex);
    return entry != NULL;
}

/* Does not sync: a map whose row is lost in a power cut is built again, and a row without a file is
 * dropped at the start. A row that cannot be written is written with the map's next change. */
int orl_map_cache_flush(struct orl_map_cache *cache, struct orl_error *err)
{
    struct orl_stored_map map;
    bool ready = false, begun = false;
    int rc = 0;
    while (rc == 0 && copy_dirty_row(cache, &map, &ready)) {
        if (!begun)
            rc = orl_db_begin(cache->db, err);
        begun = rc == 0;
        if (rc == 0)
            rc = ready ? orl_map_row_put(cache->db, &map, err)
                       : orl_map_row_drop(cache->db, map.info.kind, map.info.key, err);
    }
    return begun ? orl_db_end(cache->db, rc, err) : rc;
}

void orl_map_cache_totals(struct orl_map_cache *cache, struct orl_map_cache_totals *ret_totals)
{
    pthread_mutex_lock(&cache->mutex);
    *ret_totals = (struct orl_map_cache_totals){.hits = cache->hits, .misses = cache->misses};
    for (const struct orl_map_entry *entry = cache->entries; entry; entry = entry->next) {
        if (entry->state != ORL_MAP_IS_READY)
            continue;
        ret_totals->entries++;
        ret_totals->bytes += entry->map.info.bytes;
        if (strcmp(entry->map.info.kind, "bsdf") == 0)
            ret_totals->bsdf_bytes += entry->map.info.bytes;
    }
    pthread_mutex_unlock(&cache->mutex);
}

static int compare_last_use(const void *a, const void *b)
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
    for (struct orl_map_entry *entry = cache->entries; entry; entry = entry->next)
        count += entry->state == ORL_MAP_IS_READY;
    struct orl_stored_map *maps = calloc(count ? count : 1, sizeof *maps);
    for (struct orl_map_entry *entry = cache->entries; entry && maps; entry = entry->next)
        if (entry->state == ORL_MAP_IS_READY) {
            maps[filled] = entry->map;
            maps[filled++].in_use = entry->pins > 0;
        }
    pthread_mutex_unlock(&cache->mutex);
    if (!maps)
        return orl_error_no_memory(err);
    qsort(maps, count, sizeof *maps, compare_last_use);
    *ret_maps = maps;
    *ret_count = count;
    return 0;
}

/* Makes a ready, unused entry unavailable until its row is deleted. */
static enum orl_map_removal begin_removal(struct orl_map_cache *cache, const char *kind,
                                          const char *key)
{
    enum orl_map_removal found = ORL_MAP_ABSENT;
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = find_entry(cache, kind, key);
    if (entry && (entry->state == ORL_MAP_IS_BUILDING || entry->pins > 0)) {
        found = ORL_MAP_IN_USE;
    } else if (entry && entry->state == ORL_MAP_IS_READY) {
        found = ORL_MAP_REMOVED;
        entry->state = ORL_MAP_IS_BEING_REMOVED;
    }
    pthread_mutex_unlock(&cache->mutex);
    return found;
}

static void end_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                        enum orl_map_state state)
{
    pthread_mutex_lock(&cache->mutex);
    struct orl_map_entry *entry = find_entry(cache, kind, key);
    entry->state = state;
    entry->dirty = entry->dirty && state == ORL_MAP_IS_READY;
    drop_spent(cache);
    pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->mutex);
}

int orl_map_cache_begin_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                                enum orl_map_removal *ret_removal, struct orl_error *err)
{
    *ret_removal = begin_removal(cache, kind, key);
    return *ret_removal == ORL_MAP_REMOVED ? orl_map_row_drop(cache->db, kind, key, err) : 0;
}

void orl_map_cache_end_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                               bool gone)
{
    char path[ORL_PATH_MAX];
    map_path(cache, kind, key, path);
    if (gone)
        orl_remove_async(cache->loop, cache->folders, path);
    end_removal(cache, kind, key, gone ? ORL_MAP_IS_ABSENT : ORL_MAP_IS_READY);
}

int orl_map_cache_remove(struct orl_map_cache *cache, const char *kind, const char *key,
                         enum orl_map_removal *ret_removal, struct orl_error *err)
{
    const int rc = orl_map_cache_begin_removal(cache, kind, key, ret_removal, err);
    if (*ret_removal == ORL_MAP_REMOVED)
        orl_map_cache_end_removal(cache, kind, key, rc == 0);
    return rc;
}

/* Loads a row at the start. Keeps it if its file exists with the recorded length; drops it
 * otherwise. */
static int load_row(void *ctx, const struct orl_stored_map *map)
{
    struct orl_map_cache *cache = ctx;
    char path[ORL_PATH_MAX];
    struct orl_map_entry *entry = add_entry(cache, map->info.kind, map->info.key);
    if (!entry)
        return ORL_ERR_NOMEM;
    map_path(cache, map->info.kind, map->info.key, path);
    const bool there = access(path, R_OK) == 0;
    entry->map = *map;
    entry->state = there ? ORL_MAP_IS_READY : ORL_MAP_IS_ABSENT;
    entry->dirty = !there;
    return 0;
}

/* Moves away files without a row, left by a crash just after a commit or by another database. A
 * file that cannot be moved, as on a full disk, stays until the next start. */
static int set_orphans_aside(struct orl_map_cache *cache, struct orl_error *err)
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
        const struct orl_map_entry *entry = NULL;
        if (sscanf(file->d_name, "%15[a-z]-%64[0-9a-f].opm", kind, key) == 2)
            entry = find_entry(cache, kind, key);
        if (!entry || entry->state != ORL_MAP_IS_READY) {
            snprintf(path, sizeof path, "maps/%s", file->d_name);
            orl_orphan_set_aside(cache->folders, path, NULL);
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
        return orl_error_no_memory(err);
    *cache = (struct orl_map_cache){
        .loop = loop, .folders = folders, .db = db, .wake = wake, .wake_ctx = wake_ctx};
    pthread_mutex_init(&cache->mutex, NULL);
    /* Waits use the monotonic clock, so a wall clock set back does not lengthen them. */
    pthread_condattr_t steady;
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_cond_init(&cache->changed, &steady);
    pthread_condattr_destroy(&steady);
    int rc = orl_map_rows(db, load_row, cache, err);
    if (rc == 0)
        rc = set_orphans_aside(cache, err);
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
        struct orl_map_entry *entry = cache->entries;
        cache->entries = entry->next;
        free(entry);
    }
    pthread_cond_destroy(&cache->changed);
    pthread_mutex_destroy(&cache->mutex);
    free(cache);
}
