#include "store/database/schema_check.h"

#include <stdbool.h>

/* Counts the columns of a table that have the name; an empty name counts all of them. */
static int count_column(struct orl_db *db, const char *table, const char *column, int *ret_count,
                        struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT count(*) FROM pragma_table_info(?) WHERE ?2 = '' OR name = ?2", "ss",
        table, column);
    if (!stmt)
        return ORL_ERR_IO;
    const int rc =
        sqlite3_step(stmt) == SQLITE_ROW ? 0 : orl_db_error(db, "its tables cannot be listed", err);
    if (rc == 0)
        *ret_count = sqlite3_column_int(stmt, 0);
    sqlite3_finalize(stmt);
    return rc;
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

int orl_schema_check(struct orl_db *db, struct orl_db *wanted, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(wanted, err,
                                        "SELECT t.name, c.name FROM sqlite_schema AS t, "
                                        "pragma_table_info(t.name) AS c WHERE t.type = 'table' "
                                        "AND t.name NOT LIKE 'sqlite_%'",
                                        "");
    if (!stmt)
        return ORL_ERR_IO;
    int rc = 0, step = SQLITE_DONE;
    while (rc == 0 && (step = sqlite3_step(stmt)) == SQLITE_ROW)
        rc = check_column(db, orl_db_text(stmt, 0), orl_db_text(stmt, 1), err);
    if (rc == 0 && step != SQLITE_DONE)
        rc = orl_db_error(wanted, "its tables cannot be listed", err);
    sqlite3_finalize(stmt);
    return rc;
}
