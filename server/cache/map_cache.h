/*
 * The photon map cache: which maps are on disk, which are being built, who uses them.
 *
 * Implements struct orl_map_store (oriel/run.h) for the workers. An entry is absent, building or
 * ready. The first job to acquire an absent map builds it; others that want it wait until it is
 * ready, or take over when the builder gives up, and poll their cancel flag meanwhile. A commit
 * that fails gives up the build; to abandon it once more does no harm. Pins count the jobs that use
 * a ready map; only one without pins is ever removed, by request or to make room (storage.h), and
 * whoever wants it meanwhile waits, and then builds it anew. A job that tops up a smaller map pins
 * and counts as a hit of that one; it waits for none that is still being built.
 *
 * Durability: commit moves the synced file into maps/ first; the row follows on the loop thread
 * (flush). A crash in between leaves a file without a row, removed at the next start; rows without
 * files are dropped then too. A map that is removed loses its row first.
 *
 * Threads: one mutex; the store's functions from any worker, everything else on the loop thread.
 * wake is called from workers, with the mutex released, when flush has something to do.
 */
#ifndef ORL_SERVER_CACHE_MAP_CACHE_H
#define ORL_SERVER_CACHE_MAP_CACHE_H

#include <uv.h>

#include <oriel/run.h>

#include "process/log.h"
#include "store/folders.h"
#include "store/maps.h"

struct orl_map_cache;

typedef void (*orl_map_cache_wake)(void *ctx);

/* Borrows loop, folders and db, which must outlive it. */
int orl_map_cache_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                       orl_map_cache_wake wake, void *wake_ctx, struct orl_map_cache **ret_cache,
                       struct orl_error *err);
void orl_map_cache_close(struct orl_map_cache *cache); /* NULL is allowed */

struct orl_map_store orl_map_cache_store(struct orl_map_cache *cache);

/* Writes what changed to the database. */
int orl_map_cache_flush(struct orl_map_cache *cache, struct orl_error *err);

struct orl_map_cache_totals {
    uint64_t entries, bytes; /* that are ready */
    uint64_t bsdf_bytes;     /* of these, those of loaded BSDFs */
    uint64_t hits, misses;   /* since the cache was opened */
};
void orl_map_cache_totals(struct orl_map_cache *cache, struct orl_map_cache_totals *ret_totals);

/* A copy of the ready maps, the latest used first; owned, free(). */
int orl_map_cache_list(struct orl_map_cache *cache, struct orl_stored_map **ret_maps,
                       size_t *ret_count, struct orl_error *err);

enum orl_map_removal { ORL_MAP_REMOVED, ORL_MAP_ABSENT, ORL_MAP_IN_USE };
/* Removes a map that no job uses or builds; else *ret_removal says why not. */
int orl_map_cache_remove(struct orl_map_cache *cache, const char *kind, const char *key,
                         enum orl_map_removal *ret_removal, struct orl_error *err);
/*
 * The same in two steps, for several in one transaction: leave takes the row away, and whoever
 * wants the map waits. After one that took it, gone: the file goes, or the map stays, as its row
 * does.
 */
int orl_map_cache_leave(struct orl_map_cache *cache, const char *kind, const char *key,
                        enum orl_map_removal *ret_removal, struct orl_error *err);
void orl_map_cache_gone(struct orl_map_cache *cache, const char *kind, const char *key, bool gone);

#endif
