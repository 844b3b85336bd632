/*
 * Makes commits survive a power cut without blocking the loop on the disk.
 *
 * The loop's commits go into SQLite's write-ahead log without a sync: they survive any end of the
 * program. On request a thread syncs the log, and then reports that on the loop. All requests that
 * arrive before the sync begins share it. Earlier commits become safe with it, since the log is in
 * order. Code that must answer for a commit waits for that, and so does code that removes files
 * which a deleted row named. The loop itself waits for the disk only at the first sync of a
 * restarted log (log_folding.h), once in ORL_FOLD_PAGES pages.
 *
 * Errors: after a failed sync the system may have dropped data that it could not write, and report
 * the next sync as successful. So from then on each request checkpoints the log into the database
 * instead, synced, until SQLite has restarted the log. If that fails too, the waiters get the
 * error, and the next request tries again.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_STORE_SETTLING_H
#define ORL_STORE_SETTLING_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "store/db.h"

struct orl_settling;

/* One waiter, owned by the caller; it must not move until settled is called. */
struct orl_settling_wait {
    /* Called on the loop: rc is 0 once all commits before the request are safe. */
    void (*settled)(struct orl_settling_wait *wait, int rc, const struct orl_error *err);
    uint64_t ticket, commit; /* ticket of the request; last commit waited for */
    struct orl_settling_wait *next;
};

/* Starts to settle commits to db, which is open at path and serves (orl_db_serve). quiet is called
 * on the loop whenever the last waiter is done. */
int orl_settling_open(uv_loop_t *loop, struct orl_db *db, const char *path,
                      void (*quiet)(void *ctx), void *ctx, struct orl_settling **ret_settling,
                      struct orl_error *err);
/* Stops, before the loop ends, once there are no waiters; NULL is allowed. */
void orl_settling_stop(struct orl_settling *settling);
/* Frees it after the loop has ended, before db is closed; NULL is allowed. */
void orl_settling_free(struct orl_settling *settling);

/* last: returns the number of the last commit. is_safe: returns true if that commit is safe on
 * disk. */
uint64_t orl_settling_last(const struct orl_settling *settling);
bool orl_settling_is_safe(const struct orl_settling *settling, uint64_t commit);
bool orl_settling_is_quiet(const struct orl_settling *settling); /* NULL is allowed */

/* Calls wait->settled later, never before it returns. */
void orl_settling_ask(struct orl_settling *settling, struct orl_settling_wait *wait);

#endif
