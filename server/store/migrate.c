#include "store/migrate.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/sha256.h>

#include "process/carried.h"
#include "process/times.h"

enum { DIGEST_HEX = 65 };

static void digest_of(const char *text, char ret_hex[DIGEST_HEX])
{
    unsigned char digest[ORL_SHA256_BYTES];
    orl_sha256(text, strlen(text), digest);
    sodium_bin2hex(ret_hex, DIGEST_HEX, digest, sizeof digest);
}

static int check_list(const struct orl_migration *list, size_t count, struct orl_error *err)
{
    for (size_t i = 0; i < count; i++)
        if (strtoul(list[i].name, NULL, 10) != i + 1)
            return orl_error_set(err, ORL_ERR_INTERNAL, "migration %s is not number %zu",
                                 list[i].name, i + 1);
    return 0;
}

/* Compares what the database records with list; *ret_applied is how many it has. */
static int check_applied(struct orl_db *db, const struct orl_migration *list, size_t count,
                         size_t *ret_applied, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT version, name, digest FROM schema_migrations ORDER BY version", "");
    if (!stmt)
        return ORL_ERR_IO;
    size_t applied = 0;
    int rc = 0, step;
    while (rc == 0 && (step = sqlite3_step(stmt)) == SQLITE_ROW) {
        const sqlite3_int64 version = sqlite3_column_int64(stmt, 0);
        char digest[DIGEST_HEX];
        if (version > (sqlite3_int64)count || applied >= count) {
            rc = orl_error_set(err, ORL_ERR_VERSION,
                               "the database was written by a later version of Oriel: it has "
                               "migration %lld, this program knows %zu",
                               (long long)version, count);
            orl_error_hint(err, "Run the later version, or give another data folder");
            break;
        }
        digest_of(list[applied].sql, digest);
        if (version != (sqlite3_int64)applied + 1 || strcmp(digest, orl_db_text(stmt, 2)) != 0)
            rc = orl_error_set(err, ORL_ERR_CORRUPT,
                               "the database's migration %lld (%s) is not the one this program has",
                               (long long)version, orl_db_text(stmt, 1));
        applied++;
    }
    if (rc == 0 && step != SQLITE_DONE)
        rc = orl_db_error(db, "cannot read the list of migrations", err);
    sqlite3_finalize(stmt);
    if (rc == 0)
        *ret_applied = applied;
    return rc;
}

static int apply(struct orl_db *db, const struct orl_migration *migration, size_t version,
                 struct orl_error *err)
{
    char digest[DIGEST_HEX];
    digest_of(migration->sql, digest);
    int rc = orl_db_begin(db, err);
    if (rc)
        return rc;
    rc = orl_db_exec(db, migration->sql, err);
    if (rc == 0)
        rc = orl_db_run(db, err, NULL,
                        "INSERT INTO schema_migrations (version, name, digest, applied_ms) "
                        "VALUES (?, ?, ?, ?)",
                        "issi", (int64_t)version, migration->name, digest, orl_time_now_ms());
    rc = orl_db_end(db, rc, err);
    if (rc)
        orl_error_at(err, migration->name, 0, NULL);
    return rc;
}

/* Of a database that holds something: what a migration did can be undone. */
static int keep_copy(struct orl_db *db, size_t applied, struct orl_error *err)
{
    const char *path = sqlite3_db_filename(db->handle, "main");
    char copy[4096];
    if (!path || !*path)
        return 0; /* in memory */
    snprintf(copy, sizeof copy, "%s.before-%04zu", path, applied + 1);
    unlink(copy); /* of an earlier attempt */
    return orl_db_run(db, err, NULL, "VACUUM INTO ?", "s", copy);
}

int orl_db_migrate(struct orl_db *db, const struct orl_migration *list, size_t count,
                   struct orl_error *err)
{
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
    if (rc == 0 && applied > 0 && applied < count)
        rc = keep_copy(db, applied, err);
    for (size_t i = applied; i < count && rc == 0; i++)
        rc = apply(db, &list[i], i + 1, err);
    return rc;
}

int orl_db_migrate_embedded(struct orl_db *db, struct orl_error *err)
{
    static const char prefix[] = "migrations/";
    struct orl_migration list[64] = {{0}};
    size_t count = 0;
    for (size_t i = 0; i < orl_carried_count(); i++) {
        const struct orl_carried_file file = orl_carried_at(i);
        if (strncmp(file.name, prefix, sizeof prefix - 1) != 0)
            continue;
        if (count == sizeof list / sizeof *list)
            return orl_error_set(err, ORL_ERR_INTERNAL, "more migrations than expected");
        list[count++] = (struct orl_migration){file.name + sizeof prefix - 1, file.text};
    }
    return orl_db_migrate(db, list, count, err);
}
