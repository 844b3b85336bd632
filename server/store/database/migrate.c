#include "store/database/db.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/sha256.h>

#include "process/embedded_files.h"
#include "process/times.h"

/* ---- The schema ------------------------------------------------------------------------------ */

/* Counts the columns of a table that have the name; an empty name counts all of them. */
static int count_column(struct orl_db *db, const char *table, const char *column, int *ret_count,
                        struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT count(*) FROM pragma_table_info(?) WHERE ?2 = '' OR name = ?2", "ss",
        table, column);
    if (orl_db_next_row(stmt))
        *ret_count = sqlite3_column_int(stmt, 0);
    return orl_db_finish(db, stmt, 0, "its tables cannot be listed", err);
}

static int refuse_incomplete(const struct orl_db *db, const char *table, const char *column,
                             bool has_table, struct orl_error *err)
{
    const char *path = sqlite3_db_filename(db->handle, "main");
    path = path && *path ? path : "the database";
    if (has_table)
        orl_error_set(err, ORL_ERR_CORRUPT, "%.200s lacks the column %.60s of its table %.60s",
                      path, column, table);
    else
        orl_error_set(err, ORL_ERR_CORRUPT, "%.200s lacks the table %.60s", path, table);
    orl_error_hint(err, "Another program has changed it: put back oriel.db from a backup, or "
                        "oriel.db.before-NNNN, the copy made before its latest migration");
    return ORL_ERR_CORRUPT;
}

static int check_column(struct orl_db *db, const char *table, const char *column,
                        struct orl_error *err)
{
    int found = 0, of_table = 0;
    int rc = count_column(db, table, column, &found, err);
    if (rc || found > 0)
        return rc;
    rc = count_column(db, table, "", &of_table, err);
    return rc ? rc : refuse_incomplete(db, table, column, of_table > 0, err);
}

/*
 * Compares the tables and columns of db with those of wanted, a database that the migrations have
 * just made. ORL_ERR_CORRUPT if db lacks one. A database that another program has changed may list
 * every migration and lack some of their tables.
 */
static int compare_schema(struct orl_db *db, struct orl_db *wanted, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(wanted, err,
                                        "SELECT t.name, c.name FROM sqlite_schema AS t, "
                                        "pragma_table_info(t.name) AS c WHERE t.type = 'table' "
                                        "AND t.name NOT LIKE 'sqlite_%'",
                                        "");
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt))
        rc = check_column(db, orl_db_text(stmt, 0), orl_db_text(stmt, 1), err);
    return orl_db_finish(wanted, stmt, rc, "its tables cannot be listed", err);
}

/* ---- The list of migrations ------------------------------------------------------------------ */

static int check_list(const struct orl_migration *list, size_t count, struct orl_error *err)
{
    for (size_t i = 0; i < count; i++)
        if (strtoul(list[i].name, NULL, 10) != i + 1)
            return orl_error_set(err, ORL_ERR_INTERNAL, "migration %s is not number %zu",
                                 list[i].name, i + 1);
    return 0;
}

static int refuse_list(struct orl_error *err, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Refuses a database whose list of migrations does not match its tables. */
static int refuse_list(struct orl_error *err, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, ORL_ERR_CORRUPT, format, args);
    va_end(args);
    orl_error_hint(err,
                   "It is damaged, or belongs to another program: put back oriel.db from a backup, "
                   "or oriel.db.before-NNNN, the copy made before its latest migration");
    return ORL_ERR_CORRUPT;
}

/* Compares the migrations that the database records with list; *ret_applied is their number. */
static int check_applied(struct orl_db *db, const struct orl_migration *list, size_t count,
                         size_t *ret_applied, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT version, name, digest FROM schema_migrations ORDER BY version", "");
    size_t applied = 0;
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const sqlite3_int64 version = sqlite3_column_int64(stmt, 0);
        char digest[ORL_SHA_HEX];
        if (version > (sqlite3_int64)count || applied >= count) {
            rc = orl_error_set(err, ORL_ERR_VERSION,
                               "the database was written by a later version of Oriel: it has "
                               "migration %lld, this program knows %zu",
                               (long long)version, count);
            orl_error_hint(err, "Run the later version, or give another data folder");
            break;
        }
        if (version > (sqlite3_int64)applied + 1) {
            rc = refuse_list(err,
                             "the database's list of migrations (schema_migrations) lacks "
                             "number %zu",
                             applied + 1);
            break;
        }
        orl_sha256_hex(list[applied].sql, strlen(list[applied].sql), digest);
        if (version != (sqlite3_int64)applied + 1 || strcmp(digest, orl_db_text(stmt, 2)) != 0)
            rc = orl_error_set(err, ORL_ERR_CORRUPT,
                               "the database's migration %lld (%s) is not the one this program has",
                               (long long)version, orl_db_text(stmt, 1));
        applied++;
    }
    rc = orl_db_finish(db, stmt, rc, "cannot read the list of migrations", err);
    if (rc == 0)
        *ret_applied = applied;
    return rc;
}

/* Refuses a database whose list of migrations is empty although it has tables. Making the tables
 * again would fail. */
static int check_unlisted(struct orl_db *db, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err,
                                        "SELECT count(*) FROM sqlite_schema WHERE type = 'table' "
                                        "AND name <> 'schema_migrations' AND name NOT LIKE "
                                        "'sqlite_%'",
                                        "");
    int rc = 0;
    if (orl_db_next_row(stmt) && sqlite3_column_int64(stmt, 0) > 0)
        rc = refuse_list(err, "the database has tables, but its list of migrations "
                              "(schema_migrations) is empty");
    return orl_db_finish(db, stmt, rc, "its tables cannot be listed", err);
}

static int apply_migration(struct orl_db *db, const struct orl_migration *migration, size_t version,
                           struct orl_error *err)
{
    char digest[ORL_SHA_HEX];
    orl_sha256_hex(migration->sql, strlen(migration->sql), digest);
    int rc = orl_db_begin(db, err);
    if (rc)
        return rc;
    rc = orl_db_exec(db, migration->sql, err);
    if (rc == 0)
        rc = orl_db_run(db, err, NULL,
                        "INSERT INTO schema_migrations (version, name, digest, applied_ms) "
                        "VALUES (?, ?, ?, ?)",
                        "issi", (int64_t)version, migration->name, digest, orl_time_now_ms());
    const bool refused = rc != 0 && (sqlite3_errcode(db->handle) & 0xff) == SQLITE_ERROR;
    rc = orl_db_end(db, rc, err);
    if (rc)
        orl_error_at(err, migration->name, 0, NULL);
    if (refused)
        orl_error_hint(
            err,
            "The tables do not match the list of migrations (schema_migrations); put back oriel.db "
            "from a backup, or oriel.db.before-NNNN, the copy made before its latest migration");
    return rc;
}

/* ---- The copy before a migration ------------------------------------------------------------ */

/* A copy of a non-empty database. It is made before a migration and renamed after it, so that a
 * failed migration does not replace an earlier copy. */
struct copy {
    char made[4096 + 8], name[4096];
};

static int make_copy(struct orl_db *db, size_t applied, struct copy *copy, struct orl_error *err)
{
    const char *path = sqlite3_db_filename(db->handle, "main");
    copy->name[0] = '\0';
    if (!path || !*path)
        return 0; /* an in-memory database */
    snprintf(copy->name, sizeof copy->name, "%s.before-%04zu", path, applied + 1);
    snprintf(copy->made, sizeof copy->made, "%s.new", copy->name);
    unlink(copy->made); /* left by an earlier attempt */
    return orl_db_run(db, err, NULL, "VACUUM INTO ?", "s", copy->made);
}

static int name_copy(const struct copy *copy, bool migrated, struct orl_error *err)
{
    if (!copy->name[0])
        return 0;
    if (!migrated)
        unlink(copy->made);
    else if (rename(copy->made, copy->name) != 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot rename %s: %s", copy->made,
                             strerror(errno));
    return 0;
}

int orl_db_migrate(struct orl_db *db, const struct orl_migration *list, size_t count,
                   struct orl_error *err)
{
    struct copy copy = {{0}, {0}};
    size_t applied = 0;
    int rc = check_list(list, count, err);
    if (rc == 0)
        rc = orl_db_exec(db,
                         "CREATE TABLE IF NOT EXISTS schema_migrations (version INTEGER PRIMARY "
                         "KEY, name TEXT NOT NULL, digest TEXT NOT NULL, applied_ms INTEGER NOT "
                         "NULL) STRICT",
                         err);
    if (rc == 0)
        rc = check_applied(db, list, count, &applied, err);
    if (rc == 0 && applied == 0)
        rc = check_unlisted(db, err);
    if (rc == 0 && applied > 0 && applied < count)
        rc = make_copy(db, applied, &copy, err);
    for (size_t i = applied; i < count && rc == 0; i++) {
        rc = apply_migration(db, &list[i], i + 1, err);
        if (i == applied) {
            const int named = name_copy(&copy, rc == 0, rc == 0 ? err : NULL);
            rc = rc ? rc : named;
        }
    }
    return rc;
}

static int check_schema(struct orl_db *db, const struct orl_migration *list, size_t count,
                        struct orl_error *err)
{
    struct orl_db made = {.handle = NULL};
    int rc = orl_db_open(&made, ":memory:", err);
    if (rc == 0)
        rc = orl_db_migrate(&made, list, count, err);
    if (rc == 0)
        rc = compare_schema(db, &made, err);
    orl_db_close(&made);
    return rc;
}

int orl_db_migrate_embedded(struct orl_db *db, struct orl_error *err)
{
    static const char prefix[] = "migrations/";
    struct orl_migration list[64] = {{0}};
    size_t count = 0;
    for (size_t i = 0; i < orl_embedded_file_count(); i++) {
        const struct orl_embedded_file file = orl_embedded_file_at(i);
        if (strncmp(file.name, prefix, sizeof prefix - 1) != 0)
            continue;
        if (count == sizeof list / sizeof *list)
            return orl_error_set(err, ORL_ERR_INTERNAL, "more migrations than expected");
        list[count++] = (struct orl_migration){file.name + sizeof prefix - 1, file.text};
    }
    const int rc = orl_db_migrate(db, list, count, err);
    return rc ? rc : check_schema(db, list, count, err);
}
