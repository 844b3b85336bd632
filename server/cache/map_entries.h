/*
 * The entries of the photon map cache, shared by map_cache.c, which workers call, and
 * map_cache_rows.c, the loop thread's side. Callers hold the mutex unless a function says
 * otherwise.
 */
#ifndef ORL_SERVER_CACHE_MAP_ENTRIES_H
#define ORL_SERVER_CACHE_MAP_ENTRIES_H

#include <pthread.h>

#include "cache/map_cache.h"

/* LEAVING: no longer ready, though its row and file may still exist. */
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
void orl_map_path(const struct orl_map_cache *cache, const char *kind, const char *key,
                  char ret_path[ORL_PATH_MAX]);
/* orl_map_find returns NULL if there is no entry; orl_map_add returns NULL when out of memory. */
struct orl_map_entry *orl_map_find(struct orl_map_cache *cache, const char *kind, const char *key);
struct orl_map_entry *orl_map_add(struct orl_map_cache *cache, const char *kind, const char *key);

#endif
