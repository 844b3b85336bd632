/*
 * Makes commits outlast a power cut without keeping the loop waiting for the disk.
 *
 * The loop's commits go into SQLite's write-ahead log without a sync: they survive the end of the
 * program, however that comes. A thread syncs the log when somebody asks, and then says so on the
 * loop; all who asked until it began share that sync. What was committed earlier is safe with it,
 * since the log is in order. Who has to answer for a commit, or takes away files that its row named
 * before, waits for that. The loop itself is kept waiting by the disk's first sync of a log begun
 * anew (log_folding.h), once in ORL_FOLD_PAGES pages.
 *
 * Errors: where a sync fails the system may have dropped what it could not write, and call the next
 * sync good; so from then on the log is folded into the database instead, page by page and synced,
 * until SQLite has begun it anew. Where that fails too, whoever asked is told, and what is asked
 * next is tried again.
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

/* Somebody who waits; theirs, and to stay in place until told. */
struct orl_settling_wait {
    /* On the loop: rc is 0 once all that was committed before the asking is safe. */
    void (*settled)(struct orl_settling_wait *wait, int rc, const struct orl_error *err);
    uint64_t ticket, commit; /* of the asking; the last one waited for */
    struct orl_settling_wait *next;
};

/* For commits to db, which is open at path and serves (orl_db_serve), from now on. quiet is called
 * on the loop whenever nobody waits any more. */
int orl_settling_open(uv_loop_t *loop, struct orl_db *db, const char *path,
                      void (*quiet)(void *ctx), void *ctx, struct orl_settling **ret_settling,
                      struct orl_error *err);
/* Before the loop ends, once nobody waits; NULL is allowed. */
void orl_settling_stop(struct orl_settling *settling);
/* After it has ended, before db is closed; NULL is allowed. */
void orl_settling_free(struct orl_settling *settling);

/* The number of the last commit, and whether that one is safe. */
uint64_t orl_settling_last(const struct orl_settling *settling);
bool orl_settling_is_safe(const struct orl_settling *settling, uint64_t commit);
bool orl_settling_is_quiet(const struct orl_settling *settling); /* NULL is allowed */

/* Calls wait->settled later, never at once. */
void orl_settling_ask(struct orl_settling *settling, struct orl_settling_wait *wait);

#endif
