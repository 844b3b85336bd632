/*
 * Checkpoints SQLite's write-ahead log ("folds" it into the database), on a thread and a connection
 * of its own. A checkpoint writes a thousand pages and syncs twice; by default the next commit has
 * to wait for that.
 *
 * If commits come so fast that the thread cannot keep up, the committing connection itself runs the
 * checkpoint once the log has ORL_WAL_MAX_PAGES pages. Most of these are copied by then.
 *
 * Errors: pages that cannot be copied stay in the log, which is as safe as before. The next commit
 * tries again.
 */
#ifndef ORL_STORE_DURABILITY_WAL_CHECKPOINT_H
#define ORL_STORE_DURABILITY_WAL_CHECKPOINT_H

#include "store/database/db.h"

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
