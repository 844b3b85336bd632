#include "store/database/db.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { BUSY_TIMEOUT_MS = 5000, SERVING_TIMEOUT_MS = 250 };

/* Returns the error code. SQLite reports a full disk as an I/O error in some calls; the system's
 * errno then decides. */
static int code_of(const struct orl_db *db)
{
    const int code = db->handle ? sqlite3_errcode(db->handle) & 0xff : SQLITE_NOMEM;
    if (code == SQLITE_FULL)
        return ORL_ERR_FULL;
    return code == SQLITE_IOERR ? orl_err_of_errno(sqlite3_system_errno(db->handle)) : ORL_ERR_IO;
}

int orl_db_error(struct orl_db *db, const char *what, struct orl_error *err)
{
    return orl_error_set(err, code_of(db), "database: %s: %s", what,
                         db->handle ? sqlite3_errmsg(db->handle) : "out of memory");
}

bool orl_db_is_damaged(const struct orl_db *db)
{
    const int code = db->handle ? sqlite3_errcode(db->handle) & 0xff : SQLITE_OK;
    return code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
}

int orl_db_exec(struct orl_db *db, const char *sql, struct orl_error *err)
{
    if (sqlite3_exec(db->handle, sql, NULL, NULL, NULL) != SQLITE_OK)
        return orl_db_error(db, "statement failed", err);
    return 0;
}

int orl_db_begin(struct orl_db *db, struct orl_error *err)
{
    return orl_db_exec(db, "BEGIN IMMEDIATE", err);
}

int orl_db_end(struct orl_db *db, int rc, struct orl_error *err)
{
    if (rc == 0)
        rc = orl_db_exec(db, "COMMIT", err);
    if (rc)
        orl_db_exec(db, "ROLLBACK", NULL);
    return rc;
}

static int open_with(struct orl_db *db, const char *path, int more, struct orl_error *err)
{
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | more;
    db->handle = NULL;
    int rc = 0;
    if (sqlite3_open_v2(path, &db->handle, flags, NULL) != SQLITE_OK)
        rc = orl_db_error(db, "cannot open", err);
    if (rc == 0 && sqlite3_busy_timeout(db->handle, BUSY_TIMEOUT_MS) != SQLITE_OK)
        rc = orl_db_error(db, "cannot set the busy timeout", err);
    if (rc == 0)
        rc = orl_db_exec(db,
                         "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                         "PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF;",
                         err);
    if (rc && orl_db_is_damaged(db))
        rc = ORL_ERR_CORRUPT;
    if (rc)
        orl_db_close(db);
    return rc;
}

int orl_db_open(struct orl_db *db, const char *path, struct orl_error *err)
{
    return open_with(db, path, SQLITE_OPEN_CREATE, err);
}

int orl_db_open_existing(struct orl_db *db, const char *path, struct orl_error *err)
{
    return open_with(db, path, 0, err);
}

static int run_check(struct orl_db *db, const char *pragma, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, pragma, "");
    int rc = 0;
    if (orl_db_next_row(stmt) && strcmp(orl_db_text(stmt, 0), "ok") != 0) {
        rc = orl_error_set(err, ORL_ERR_CORRUPT, "the database is damaged: %.200s",
                           orl_db_text(stmt, 0));
        orl_error_hint(err, "Restore the data folder from a backup, or give another one");
    }
    return orl_db_finish(db, stmt, rc, "cannot be checked", err);
}

int orl_db_check(struct orl_db *db, struct orl_error *err)
{
    return run_check(db, "PRAGMA integrity_check(1)", err);
}

/* Starts the write-ahead log with a commit that changes nothing. The first commit to a new log
 * waits until its folder and header are synced, so later commits need not. */
static int begin_log(struct orl_db *db, struct orl_error *err)
{
    char again[64];
    sqlite3_stmt *stmt = orl_db_prepare(db, err, "PRAGMA user_version", "");
    snprintf(again, sizeof again, "PRAGMA user_version = %d",
             orl_db_next_row(stmt) ? sqlite3_column_int(stmt, 0) : 0);
    const int rc = orl_db_finish(db, stmt, 0, "cannot be read", err);
    return rc ? rc : orl_db_exec(db, again, err);
}

int orl_db_serve(struct orl_db *db, struct orl_error *err)
{
    int rc = run_check(db, "PRAGMA quick_check(1)", err);
    if (rc == 0)
        rc = begin_log(db, err);
    if (rc == 0)
        rc = orl_db_exec(db, "PRAGMA synchronous = NORMAL", err);
    sqlite3_busy_timeout(db->handle, SERVING_TIMEOUT_MS);
    return rc;
}

void orl_db_close(struct orl_db *db)
{
    sqlite3_close(db->handle);
    db->handle = NULL;
}

static int bind_arguments(sqlite3_stmt *stmt, const char *types, va_list args)
{
    int rc = SQLITE_OK;
    for (int i = 0; types[i] && rc == SQLITE_OK; i++) {
        if (types[i] == 's') {
            const char *text = va_arg(args, const char *);
            rc = text ? sqlite3_bind_text(stmt, i + 1, text, -1, SQLITE_TRANSIENT)
                      : sqlite3_bind_null(stmt, i + 1);
        } else if (types[i] == 'i') {
            rc = sqlite3_bind_int64(stmt, i + 1, va_arg(args, int64_t));
        } else if (types[i] == 'd') {
            rc = sqlite3_bind_double(stmt, i + 1, va_arg(args, double));
        } else {
            rc = SQLITE_MISUSE;
        }
    }
    return rc;
}

static sqlite3_stmt *prepare_with(struct orl_db *db, struct orl_error *err, const char *sql,
                                  const char *types, va_list args)
{
    sqlite3_stmt *stmt = NULL;
    if (sqlite3_prepare_v2(db->handle, sql, -1, &stmt, NULL) != SQLITE_OK) {
        orl_db_error(db, "cannot prepare a statement", err);
        return NULL;
    }
    if (bind_arguments(stmt, types, args) != SQLITE_OK) {
        orl_db_error(db, "cannot bind arguments", err);
        sqlite3_finalize(stmt);
        return NULL;
    }
    return stmt;
}

sqlite3_stmt *orl_db_prepare(struct orl_db *db, struct orl_error *err, const char *sql,
                             const char *types, ...)
{
    va_list args;
    va_start(args, types);
    sqlite3_stmt *stmt = prepare_with(db, err, sql, types, args);
    va_end(args);
    return stmt;
}

int orl_db_run(struct orl_db *db, struct orl_error *err, int *ret_changes, const char *sql,
               const char *types, ...)
{
    va_list args;
    va_start(args, types);
    sqlite3_stmt *stmt = prepare_with(db, err, sql, types, args);
    va_end(args);
    int rc = 0;
    if (orl_db_next_row(stmt))
        rc = orl_db_error(db, "statement failed", err);
    rc = orl_db_finish(db, stmt, rc, "statement failed", err);
    if (rc == 0 && ret_changes)
        *ret_changes = sqlite3_changes(db->handle);
    return rc;
}

bool orl_db_next_row(sqlite3_stmt *stmt)
{
    return stmt && sqlite3_step(stmt) == SQLITE_ROW;
}

int orl_db_finish(struct orl_db *db, sqlite3_stmt *stmt, int rc, const char *what,
                  struct orl_error *err)
{
    if (!stmt)
        return ORL_ERR_IO;
    return sqlite3_finalize(stmt) != SQLITE_OK && rc == 0 ? orl_db_error(db, what, err) : rc;
}

const char *orl_db_text(sqlite3_stmt *stmt, int column)
{
    const char *text = (const char *)sqlite3_column_text(stmt, column);
    return text ? text : "";
}
