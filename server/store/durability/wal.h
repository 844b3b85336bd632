/*
 * SQLite's write-ahead log: syncs that make commits durable (wal_sync.c), and checkpoints
 * (wal_checkpoint.c).
 */
#ifndef ORL_STORE_DURABILITY_WAL_H
#define ORL_STORE_DURABILITY_WAL_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "store/database/db.h"

/*
 * Makes commits survive a power cut without blocking the loop on the disk.
 *
 * The loop's commits go into SQLite's write-ahead log without a sync: they survive any end of the
 * program. On request a thread syncs the log, and then reports that on the loop. All requests that
 * arrive before the sync begins share it. Earlier commits become safe with it, since the log is in
 * order. Code that must answer for a commit waits for that, and so does code that removes files
 * which a deleted row named. The loop itself waits for the disk only at the first sync of a
 * restarted log, once in ORL_WAL_CHECKPOINT_PAGES pages.
 *
 * Errors: after a failed sync the system may have dropped data that it could not write, and report
 * the next sync as successful. So from then on each request checkpoints the log into the database
 * instead, synced, until SQLite has restarted the log. If that fails too, the waiters get the
 * error, and the next request tries again.
 *
 * Threads: the loop thread.
 */

struct orl_wal_sync;

/* One waiter, owned by the caller; it must not move until synced is called. */
struct orl_wal_sync_wait {
    /* Called on the loop: rc is 0 once all commits before the request are safe. */
    void (*synced)(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err);
    uint64_t ticket, commit; /* ticket of the request; last commit waited for */
    struct orl_wal_sync_wait *next;
};

/* Starts to sync commits to db, which is open at path and serves (orl_db_serve). on_idle is called
 * on the loop whenever the last waiter is done. */
int orl_wal_sync_open(uv_loop_t *loop, struct orl_db *db, const char *path,
                      void (*on_idle)(void *ctx), void *ctx, struct orl_wal_sync **ret_wal_sync,
                      struct orl_error *err);
/* Stops, before the loop ends, once there are no waiters; NULL is allowed. */
void orl_wal_sync_stop(struct orl_wal_sync *wal_sync);
/* Frees it after the loop has ended, before db is closed; NULL is allowed. */
void orl_wal_sync_free(struct orl_wal_sync *wal_sync);

/* last_commit: returns the number of the last commit. is_durable: returns true if that commit is
 * safe on disk. is_idle: returns true if there are no waiters. */
uint64_t orl_wal_sync_last_commit(const struct orl_wal_sync *wal_sync);
bool orl_wal_sync_is_durable(const struct orl_wal_sync *wal_sync, uint64_t commit);
bool orl_wal_sync_is_idle(const struct orl_wal_sync *wal_sync); /* NULL is allowed */

/* Calls wait->synced later, never before it returns. */
void orl_wal_sync_request(struct orl_wal_sync *wal_sync, struct orl_wal_sync_wait *wait);

/*
 * Checkpoints: copies SQLite's write-ahead log into the database, on a thread and a connection of
 * its own. A checkpoint writes a thousand pages and syncs twice; by default the next commit has
 * to wait for that.
 *
 * If commits come so fast that the thread cannot keep up, the committing connection itself runs the
 * checkpoint once the log has ORL_WAL_MAX_PAGES pages. Most of these are copied by then.
 *
 * Errors: pages that cannot be copied stay in the log, which is as safe as before. The next commit
 * tries again.
 */

enum { ORL_WAL_CHECKPOINT_PAGES = 1000, ORL_WAL_MAX_PAGES = 8 * ORL_WAL_CHECKPOINT_PAGES };

struct orl_wal_checkpointer;

/* Starts checkpoints of db's log, from its next commit on. path: where db is open. Threads: those
 * of db. */
int orl_wal_checkpointer_open(struct orl_db *db, const char *path,
                              struct orl_wal_checkpointer **ret_checkpointer,
                              struct orl_error *err);
/* Waits for a running checkpoint. Call it before db is closed; NULL is allowed. */
void orl_wal_checkpointer_close(struct orl_wal_checkpointer *checkpointer);

#endif
