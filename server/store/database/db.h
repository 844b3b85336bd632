/*
 * The SQLite database of one data folder: statements (db.c), migrations and the check of their
 * result (migrate.c), and opening the database with its folder (store_open.c).
 */
#ifndef ORL_STORE_DATABASE_DB_H
#define ORL_STORE_DATABASE_DB_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "store/files/folders.h"

/*
 * Opening, pragmas, statements.
 *
 * Invariants: WAL, foreign keys on, synchronous=FULL, so that a committed row survives a power cut;
 * but see orl_db_serve. Rows name files; a row is written only when its file is in place. Threads:
 * the loop thread only. Errors: ORL_ERR_IO with SQLite's message; ORL_ERR_VERSION for a database of
 * a later Oriel.
 */

struct orl_db {
    sqlite3 *handle;
};

/* Opens or creates path. Does not migrate. ORL_ERR_CORRUPT if the file is damaged. */
int orl_db_open(struct orl_db *db, const char *path, struct orl_error *err);
/* Opens an existing database. */
int orl_db_open_existing(struct orl_db *db, const char *path, struct orl_error *err);
/* Reads the whole database. ORL_ERR_CORRUPT if it is damaged. */
int orl_db_check(struct orl_db *db, struct orl_error *err);
/*
 * Prepares the database of a daemon that is about to serve. Refuses a damaged database
 * (ORL_ERR_CORRUPT). From then on calls wait only briefly for another program's lock, and not for
 * the disk, since they block the loop. A commit survives the end of the program, and a power cut
 * once it is durable (wal.h).
 */
int orl_db_serve(struct orl_db *db, struct orl_error *err);
void orl_db_close(struct orl_db *db); /* a zeroed struct is allowed */

/* Fills err with SQLite's message; returns ORL_ERR_IO. */
int orl_db_error(struct orl_db *db, const char *what, struct orl_error *err);

/* Returns true if the last call failed because the file is damaged or not a database. */
bool orl_db_is_damaged(const struct orl_db *db);

/* Runs one or more statements without arguments. */
int orl_db_exec(struct orl_db *db, const char *sql, struct orl_error *err);

/* Begins a transaction. */
int orl_db_begin(struct orl_db *db, struct orl_error *err);
/* Ends the transaction: commits if rc is 0, otherwise rolls back. Returns rc, or the error of the
 * commit. */
int orl_db_end(struct orl_db *db, int rc, struct orl_error *err);

/*
 * Prepares sql and binds its arguments, one letter of types each: 's' const char * (NULL binds
 * NULL; copied), 'i' int64_t, 'd' double. NULL on failure. The caller steps and finalizes.
 */
sqlite3_stmt *orl_db_prepare(struct orl_db *db, struct orl_error *err, const char *sql,
                             const char *types, ...);

/* Steps to the next row. Returns false after the last one, after an error, and if stmt is NULL. */
bool orl_db_next_row(sqlite3_stmt *stmt);
/* Finalizes a statement after its last step. Returns rc if it is not 0, else 0, or ORL_ERR_IO if
 * stmt is NULL (err was set by orl_db_prepare) or the step failed: what says what cannot be done.
 */
int orl_db_finish(struct orl_db *db, sqlite3_stmt *stmt, int rc, const char *what,
                  struct orl_error *err);

/* Runs orl_db_prepare, one step that must yield no row, and finalize. *ret_changes may be NULL. */
int orl_db_run(struct orl_db *db, struct orl_error *err, int *ret_changes, const char *sql,
               const char *types, ...);

/* Returns a column as text; "" for NULL. Valid until the next step. */
const char *orl_db_text(sqlite3_stmt *stmt, int column);

/*
 * Migrates a database to the current schema.
 *
 * Migrations are numbered from 1 without gaps, append-only, each run in one transaction together
 * with the row that records its number and digest. A database with a later number than the
 * program's is refused (ORL_ERR_VERSION). So is one with a different recorded digest
 * (ORL_ERR_CORRUPT): a migration that has been applied somewhere may never be edited.
 *
 * Before the first new migration, a copy of the database is left beside it, as
 * <path>.before-<number>. To go back to an earlier Oriel, put the copy in its place.
 */

struct orl_migration {
    const char *name; /* "0001_initial.sql"; the digits are its number */
    const char *sql;
};

/* Applies the migrations of list (sorted by number) that the database lacks. */
int orl_db_migrate(struct orl_db *db, const struct orl_migration *list, size_t count,
                   struct orl_error *err);

/* Applies the migrations embedded in the daemon. ORL_ERR_CORRUPT: all are applied, but a table or a
 * column that they make is missing. */
int orl_db_migrate_embedded(struct orl_db *db, struct orl_error *err);

/*
 * Opens the database of a data folder and migrates it, after a check that the two belong together.
 * Refused (ORL_ERR_CORRUPT) are
 *
 *   - files of scenes, jobs or maps without a database, or with an empty one: it was lost;
 *   - a database whose id is not the one in the folder's file oriel.id: it is another folder's.
 *
 * In the first case, ORL_LOST_DATABASE_SET_ASIDE starts with a new database: the files, and the
 * rest of the database, move to orphans/ (removal.h). In the second case it adopts the database;
 * files that this does not know are then orphans.
 *
 * A folder from before ids were introduced gets the id of its database. Copies of a database have
 * its id, so an older backup of the folder's own database is accepted.
 */

enum orl_lost_database_policy { ORL_LOST_DATABASE_REFUSE, ORL_LOST_DATABASE_SET_ASIDE };

/* Opens and migrates the database of the data folder, which this process has opened and locked. */
int orl_store_open(const struct orl_folders *folders, enum orl_lost_database_policy opening,
                   struct orl_db *ret_db, struct orl_error *err);

#endif
