/*
 * How files leave the data folder: they are deleted on the pool, or set aside as orphans. The
 * retention clock measures the age of jobs and orphans.
 */
#ifndef ORL_SERVER_STORE_FILES_REMOVAL_H
#define ORL_SERVER_STORE_FILES_REMOVAL_H

#include <stdint.h>
#include <uv.h>

#include "store/database/db.h"
#include "store/durability/wal.h"
#include "store/files/folders.h"

/*
 * Removes files without blocking the loop: a rename into tmp/ takes them away at once, and the pool
 * deletes them. Files left there by a crash are removed when tmp/ is emptied.
 *
 * Threads: the loop thread.
 */

/* Removes a file or a folder, if it exists. Borrows folders until the loop has ended. */
void orl_remove_async(uv_loop_t *loop, const struct orl_folders *folders, const char *path);
/* Removes it later, once all commits so far are safe on disk. So no power cut can bring back a row
 * that names it. If that fails, the file stays for the next start. */
void orl_remove_when_durable(struct orl_wal_sync *wal_sync, uv_loop_t *loop,
                             const struct orl_folders *folders, const char *path);

/*
 * Orphans: files of the data folder that its database does not know. A crash leaves a few. If a
 * database was lost, or an older copy of it was restored, they may be all files there are. No start
 * deletes them. It moves them to
 *
 *     orphans/<time of the start>/blobs/... maps/... results/... partial/...
 *
 * under their original paths, so that moving them back undoes it. A later start, or a pass once an
 * hour, removes those folders when they are older than --keep-orphans days.
 *
 * Threads: the loop thread.
 */

/* Moves a file or folder, such as "results/<job>", aside. below: its path in the data folder. A
 * missing one is no error. */
int orl_orphan_set_aside(const struct orl_folders *folders, const char *below,
                         struct orl_error *err);

/* Files set aside by this start so far. */
struct orl_orphans_found {
    uint64_t files, bytes;
};
struct orl_orphans_found orl_orphans_count(const struct orl_folders *folders);
/* Writes the path of this start's folder of orphans. */
void orl_orphans_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX]);

/* Removes the folders of earlier starts that are more than keep_days older than now_ms. */
void orl_orphans_purge(uv_loop_t *loop, const struct orl_folders *folders, int64_t now_ms,
                       uint32_t keep_days);

/*
 * The clock for the age of jobs and orphans. It starts with the wall clock and then counts the time
 * that a daemon runs, by the monotonic clock; a pause between two runs counts as an hour at most.
 * So a wall clock that jumps forwards, while the daemon runs or between two runs, makes nothing old
 * enough to be removed. One that jumps back makes nothing younger.
 *
 * The time is saved in the database once an hour and at the end. Time lost in a crash only keeps
 * things longer.
 *
 * Threads: the loop thread.
 */

struct orl_retention_clock {
    struct orl_db *db;
    int64_t base_ms; /* its time when the monotonic clock was at steady_ms */
    int64_t steady_ms;
    int64_t saved_ms;
};

/* Reads the time of a migrated database. Borrows db. */
int orl_retention_clock_open(struct orl_retention_clock *clock, struct orl_db *db,
                             struct orl_error *err);
/* Returns milliseconds comparable with those since 1970, but behind by the time lost in pauses. */
int64_t orl_retention_clock_ms(const struct orl_retention_clock *clock);
/* Saves the time if the last save was an hour ago; best effort. */
void orl_retention_clock_tick(struct orl_retention_clock *clock);
void orl_retention_clock_save(struct orl_retention_clock *clock);

#endif
