/*
 * Folds SQLite's write-ahead log into the database (a checkpoint, in SQLite's words), on a thread
 * and a connection of its own: it writes a thousand pages and syncs twice, and by default whoever
 * commits next has to wait for that.
 *
 * Where commits come so fast that the log is never caught up with, the connection that commits
 * folds it itself once it has grown to ORL_FOLD_AT_MOST pages, most of which are done by then.
 *
 * Errors: what cannot be folded stays in the log, as safe as before, and is tried with the next
 * commit.
 */
#ifndef ORL_STORE_LOG_FOLDING_H
#define ORL_STORE_LOG_FOLDING_H

#include "store/db.h"

enum { ORL_FOLD_PAGES = 1000, ORL_FOLD_AT_MOST = 8 * ORL_FOLD_PAGES };

struct orl_folding;

/* For the log of db, which is open at path, from its next commit on. Threads: those of db. */
int orl_folding_open(struct orl_db *db, const char *path, struct orl_folding **ret_folding,
                     struct orl_error *err);
/* Waits for one that goes on. Before db is closed; NULL is allowed. */
void orl_folding_close(struct orl_folding *folding);

#endif
