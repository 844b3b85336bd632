/*
 * The SQLite database of one data folder: opening, pragmas, statements.
 *
 * Invariants: WAL, foreign keys on, synchronous=FULL, so that a row that was committed survives a
 * power cut; but see orl_db_serve. Rows name files; a row is written only when its file is in
 * place. Threads: the loop thread only. Errors: ORL_ERR_IO with SQLite's own words; ORL_ERR_VERSION
 * for a database of a later Oriel.
 */
#ifndef ORL_STORE_DB_H
#define ORL_STORE_DB_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_db {
    sqlite3 *handle;
};

/* Opens or creates path. Does not migrate. ORL_ERR_CORRUPT when the file is damaged. */
int orl_db_open(struct orl_db *db, const char *path, struct orl_error *err);
/* Opens one that is there. */
int orl_db_open_existing(struct orl_db *db, const char *path, struct orl_error *err);
/* Reads all of it: ORL_ERR_CORRUPT when it is damaged. */
int orl_db_check(struct orl_db *db, struct orl_error *err);
/*
 * For a daemon that is about to serve: refuses a damaged database (ORL_ERR_CORRUPT). From then on
 * it waits but a moment for another program's lock, and not for the disk, since everybody waits
 * meanwhile: a commit survives the end of the program, and a power cut once it is settled
 * (settling.h).
 */
int orl_db_serve(struct orl_db *db, struct orl_error *err);
void orl_db_close(struct orl_db *db); /* a zeroed struct is fine */

/* Fills err with what SQLite says; returns ORL_ERR_IO. */
int orl_db_error(struct orl_db *db, const char *what, struct orl_error *err);

/* The last call failed because the file is damaged, or no database at all. */
bool orl_db_is_damaged(const struct orl_db *db);

/* One or more statements without arguments. */
int orl_db_exec(struct orl_db *db, const char *sql, struct orl_error *err);

/* A transaction. */
int orl_db_begin(struct orl_db *db, struct orl_error *err);
/* Ends what was begun: kept when rc is 0, else as if nothing had been. Returns rc, or why not. */
int orl_db_end(struct orl_db *db, int rc, struct orl_error *err);

/*
 * Prepares sql and binds its arguments, one letter of types each: 's' const char * (NULL binds
 * NULL; copied), 'i' int64_t, 'd' double. NULL on failure. The caller steps and finalizes.
 */
sqlite3_stmt *orl_db_prepare(struct orl_db *db, struct orl_error *err, const char *sql,
                             const char *types, ...);

/* orl_db_prepare, one step that must yield no row, finalize. *ret_changes may be NULL. */
int orl_db_run(struct orl_db *db, struct orl_error *err, int *ret_changes, const char *sql,
               const char *types, ...);

/* Column as text; "" for NULL. Valid until the next step. */
const char *orl_db_text(sqlite3_stmt *stmt, int column);

#endif
