/* The storage budget (storage.c), and the disk space reserved for the database (disk_reserve.c). */
#ifndef ORL_SERVER_MAINTENANCE_STORAGE_H
#define ORL_SERVER_MAINTENANCE_STORAGE_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "cache/map_cache.h"
#include "http/quota/quota.h"
#include "jobs/jobs.h"
#include "process/log.h"
#include "store/files/blobs.h"
#include "store/files/folders.h"

/*
 * The storage budget: the bytes that photon maps, loaded BSDFs, results and uploads may take
 * together.
 *
 * When they take more, maps and results are evicted, least recently used first, until they fit the
 * budget. This happens at once when something is stored, and before something new is accepted.
 * Never evicted are maps that a running job uses or builds, and data of jobs that wait or run
 * (their scenes, documents, finished views). Nor are uploads, which only their owners remove, or
 * results that were never fetched, for ORL_SERVER_UNFETCHED_S after the job ended. If that does not
 * free enough, new uploads and jobs are refused (507) and accepted ones continue. A job is accepted
 * if its expected results fit beside those of all jobs that wait or run.
 *
 * Data in flight counts too: bodies on disk, and files unpacked from them (quota.h). Data that does
 * not fit is refused by its Content-Length, or once it reaches the bound.
 *
 * Not counted: maps being built, work folders of running jobs, the database, and folders.
 * Threads: the loop thread; any thread may reserve bytes in the quota.
 */

struct orl_request;

enum orl_stored { ORL_STORED_MAPS, ORL_STORED_BSDFS, ORL_STORED_RESULTS, ORL_STORED_UPLOADS };
enum { ORL_STORED_COUNT = 4 };
extern const char *const orl_stored_names[ORL_STORED_COUNT]; /* "maps", "bsdfs", ... */

struct orl_storage {
    uint64_t budget;
    struct orl_quota
        upload_quota; /* quota of data in flight: the budget without data that must stay */
    struct orl_db *db;
    struct orl_map_cache *maps;
    struct orl_jobs *jobs;
    struct orl_blobs *blobs;
    const struct orl_log *log;
    const struct orl_retention_clock *clock;
    uint64_t evicted[ORL_STORED_COUNT]; /* number of evictions since the start */
    uv_timer_t fetch_timer;             /* saves the times of fetches periodically */
};

/* Returns the default budget: half of the file system's free bytes and of the bytes that the daemon
 * already uses. */
uint64_t orl_storage_default(const char *folder, uint64_t used);

void orl_storage_usage(const struct orl_storage *storage, uint64_t ret_bytes[ORL_STORED_COUNT]);
uint64_t orl_storage_total(const struct orl_storage *storage);
/* Evicts data until the budget is met. */
void orl_storage_evict(struct orl_storage *storage);

/* Makes space for so many more bytes, of which reservation has some. Returns false if that is
 * impossible. */
bool orl_storage_admit(struct orl_storage *storage, const struct orl_reservation *reservation,
                       uint64_t bytes);

/* Reserves space for a body of so many bytes before it arrives. Returns false if it does
 * not fit. */
bool orl_storage_reserve_body(struct orl_storage *storage, struct orl_reservation *reservation,
                              uint64_t bytes);
/* Evicts data if data in flight has grown. Called about every second. */
void orl_storage_check(struct orl_storage *storage);

/* Records that a job's results were fetched. */
void orl_storage_fetched(struct orl_storage *storage, const char *job_id);
/* Saves the times of fetches, and closes the timer. */
void orl_storage_stop(struct orl_storage *storage);

/*
 * Reserves disk space for the database, so that a daemon can start on a full disk and remove stored
 * files.
 *
 * The file oriel.reserve takes ORL_RESERVE_BYTES while there is space for it. A start with less
 * free space removes it before it opens the database, which needs space for its log and index. The
 * start then allocates most of that space after the end of the log, so rows can be deleted however
 * full the disk is. The disk counts as full if less than ORL_DISK_LEAST is free, or while the
 * reserve could not be made.
 *
 * On a full disk uploads and jobs are refused and no job starts; everything else continues.
 *
 * Threads: the loop thread.
 */

#define ORL_RESERVE_BYTES (6L << 20)
/* More than the pages that are in the log at a checkpoint. */
#define ORL_WAL_RESERVE_BYTES (5L << 20)
#define ORL_DISK_LEAST (1L << 20)

struct orl_disk_reserve {
    const struct orl_folders *folders;
    const struct orl_log *log;
    bool reserved, full;
};

/* Opens the reserve, before the database is opened. Borrows both. */
void orl_disk_reserve_open(struct orl_disk_reserve *reserve, const struct orl_folders *folders,
                           const struct orl_log *log);
/* Allocates the log's space, once there is a log; best effort. */
void orl_disk_reserve_wal(const struct orl_disk_reserve *reserve);
/* Checks the disk; called about every second. Returns true if full has changed. */
bool orl_disk_reserve_check(struct orl_disk_reserve *reserve);
/* Makes the reserve for the next start. Call it after the database is closed, which removes the
 * log. */
void orl_disk_reserve_close(struct orl_disk_reserve *reserve); /* a zeroed struct is allowed */

#endif
