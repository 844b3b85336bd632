/*
 * The photon map cache: records which maps are on disk, which are being built, and which jobs use
 * them.
 *
 * Implements struct orl_map_store (oriel/job/run.h) for the workers. An entry is absent, building
 * or ready. The first job to acquire an absent map builds it. Other jobs that want it wait until it
 * is ready, or take over when the builder gives up; they poll their cancel flag meanwhile. A commit
 * that fails gives up the build; abandoning it again is harmless. Pins count the jobs that use a
 * ready map. Only a map without pins is ever removed, by request or to free disk space (storage.h).
 * A job that wants the map during the removal waits, and then builds it anew. A job that tops up a
 * smaller map pins that map and counts as a hit of it. Such a job does not wait for a smaller map
 * that is still being built.
 *
 * Durability: commit moves the synced file into maps/ first; the row follows on the loop thread
 * (flush). A crash in between leaves a file without a row, which the next start sets aside
 * (removal.h). The next start also drops rows without files. A map that is removed loses its row
 * first.
 *
 * Threads: one mutex; the store's functions from any worker, everything else on the loop thread.
 * Workers call wake, with the mutex released, when flush has something to do.
 */
#ifndef ORL_SERVER_CACHE_MAP_CACHE_H
#define ORL_SERVER_CACHE_MAP_CACHE_H

#include <uv.h>

#include <oriel/job/run.h>

#include "process/log.h"
#include "store/files/folders.h"
#include "store/rows/stored_maps.h"

struct orl_map_cache;

typedef void (*orl_map_cache_wake)(void *ctx);

/* Opens the cache. Borrows loop, folders and db, which must outlive it. */
int orl_map_cache_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                       orl_map_cache_wake wake, void *wake_ctx, struct orl_map_cache **ret_cache,
                       struct orl_error *err);
void orl_map_cache_close(struct orl_map_cache *cache); /* NULL is allowed */

struct orl_map_store orl_map_cache_store(struct orl_map_cache *cache);

/* Writes what changed to the database. */
int orl_map_cache_flush(struct orl_map_cache *cache, struct orl_error *err);

struct orl_map_cache_totals {
    uint64_t entries, bytes; /* ready maps */
    uint64_t bsdf_bytes;     /* the part of bytes that is loaded BSDFs */
    uint64_t hits, misses;   /* since the cache was opened */
};
void orl_map_cache_totals(struct orl_map_cache *cache, struct orl_map_cache_totals *ret_totals);

/* Copies the list of ready maps, most recently used first. The caller owns it; free(). */
int orl_map_cache_list(struct orl_map_cache *cache, struct orl_stored_map **ret_maps,
                       size_t *ret_count, struct orl_error *err);

enum orl_map_removal { ORL_MAP_REMOVED, ORL_MAP_ABSENT, ORL_MAP_IN_USE };
/* Removes a map if no job uses or builds it; *ret_removal is the outcome. */
int orl_map_cache_remove(struct orl_map_cache *cache, const char *kind, const char *key,
                         enum orl_map_removal *ret_removal, struct orl_error *err);
/*
 * Removes a map in two steps, so that several can go in one transaction.
 * orl_map_cache_begin_removal deletes the row; jobs that want the map wait from then on. After each
 * call that returned ORL_MAP_REMOVED, call orl_map_cache_end_removal. gone is true: the file is
 * deleted. gone is false (the transaction failed): the map stays, like its row.
 */
int orl_map_cache_begin_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                                enum orl_map_removal *ret_removal, struct orl_error *err);
void orl_map_cache_end_removal(struct orl_map_cache *cache, const char *kind, const char *key,
                               bool gone);

#endif
