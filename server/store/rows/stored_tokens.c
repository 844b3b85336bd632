#include "store/rows/stored_tokens.h"

#include <stdio.h>
#include <string.h>

static const char *const scope_names[ORL_SCOPE_COUNT] = {"open", "read", "submit", "admin"};

const char *orl_scope_name(enum orl_token_scope scope)
{
    return scope < ORL_SCOPE_COUNT ? scope_names[scope] : "unknown";
}

enum orl_token_scope orl_scope_from_name(const char *name)
{
    unsigned scope = ORL_SCOPE_READ;
    while (scope < ORL_SCOPE_COUNT && strcmp(scope_names[scope], name) != 0)
        scope++;
    return (enum orl_token_scope)scope;
}

int orl_token_row_insert(struct orl_db *db, const struct orl_token_row *row, struct orl_error *err)
{
    int changes = 0;
    const int rc = orl_db_run(
        db, err, &changes,
        "INSERT INTO tokens (name, id, hash, scope, created_ms) VALUES (?, ?, ?, ?, ?) "
        "ON CONFLICT (name) DO NOTHING",
        "ssssi", row->name, row->id, row->hash, orl_scope_name(row->scope), row->created_ms);
    if (rc == 0 && changes == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "there is a token named '%s' already",
                             row->name);
    return rc;
}

int orl_token_row_remove(struct orl_db *db, const char *name, struct orl_error *err)
{
    int changes = 0;
    const int rc = orl_db_run(db, err, &changes, "DELETE FROM tokens WHERE name = ?", "s", name);
    if (rc == 0 && changes == 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no token named '%s'", name);
    return rc;
}

/* Reads the statement's current row; the token's columns come first. */
static struct orl_token_row read_token_row(sqlite3_stmt *stmt)
{
    struct orl_token_row row = {.scope = orl_scope_from_name(orl_db_text(stmt, 3)),
                                .created_ms = sqlite3_column_int64(stmt, 4)};
    snprintf(row.name, sizeof row.name, "%s", orl_db_text(stmt, 0));
    snprintf(row.id, sizeof row.id, "%s", orl_db_text(stmt, 1));
    snprintf(row.hash, sizeof row.hash, "%s", orl_db_text(stmt, 2));
    return row;
}

sqlite3_stmt *orl_token_find_statement(struct orl_db *db, struct orl_error *err)
{
    return orl_db_prepare(
        db, err, "SELECT name, id, hash, scope, created_ms FROM tokens WHERE id = ?", "s", "");
}

int orl_token_row_find(struct orl_db *db, sqlite3_stmt *statement, const char *id,
                       struct orl_token_row *ret_row, bool *ret_found, struct orl_error *err)
{
    int rc = 0, step = SQLITE_ERROR;
    if (sqlite3_bind_text(statement, 1, id, -1, SQLITE_STATIC) == SQLITE_OK)
        step = sqlite3_step(statement);
    if (step == SQLITE_ROW)
        *ret_row = read_token_row(statement);
    else if (step != SQLITE_DONE)
        rc = orl_db_error(db, "cannot read tokens", err);
    sqlite3_reset(statement); /* ends the read, so that the next one sees later changes */
    if (rc == 0)
        *ret_found = step == SQLITE_ROW;
    return rc;
}

int orl_token_rows(struct orl_db *db, int (*visit)(void *ctx, const struct orl_token_row *row),
                   void *ctx, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT name, id, hash, scope, created_ms FROM tokens ORDER BY name", "");
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const struct orl_token_row row = read_token_row(stmt);
        rc = visit(ctx, &row);
    }
    return orl_db_finish(db, stmt, rc, "cannot read tokens", err);
}

/* ---- Sessions -------------------------------------------------------------------------------- */

int orl_session_row_insert(struct orl_db *db, const char *hash, const char *token_id,
                           int64_t now_ms, int64_t expires_ms, unsigned most, struct orl_error *err)
{
    int rc = orl_db_begin(db, err);
    if (rc)
        return rc;
    rc = orl_db_run(db, err, NULL, "DELETE FROM sessions WHERE expires_ms <= ?", "i", now_ms);
    if (rc == 0)
        rc = orl_db_run(db, err, NULL,
                        "INSERT INTO sessions (hash, token, created_ms, expires_ms) "
                        "VALUES (?, ?, ?, ?)",
                        "ssii", hash, token_id, now_ms, expires_ms);
    if (rc == 0)
        rc = orl_db_run(db, err, NULL,
                        "DELETE FROM sessions WHERE hash IN (SELECT hash FROM sessions WHERE token "
                        "= ? ORDER BY created_ms DESC, hash LIMIT -1 OFFSET ?)",
                        "si", token_id, (int64_t)most);
    return orl_db_end(db, rc, err);
}

int orl_session_row_find(struct orl_db *db, const char *hash, int64_t now_ms,
                         struct orl_session_row *ret_row, bool *ret_found, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err,
        "SELECT t.name, t.id, t.hash, t.scope, t.created_ms, s.expires_ms FROM sessions s "
        "JOIN tokens t ON t.id = s.token WHERE s.hash = ? AND s.expires_ms > ?",
        "si", hash, now_ms);
    const bool found = orl_db_next_row(stmt);
    if (found) {
        snprintf(ret_row->hash, sizeof ret_row->hash, "%s", hash);
        ret_row->token = read_token_row(stmt);
        ret_row->expires_ms = sqlite3_column_int64(stmt, 5);
    }
    const int rc = orl_db_finish(db, stmt, 0, "cannot read sessions", err);
    if (rc == 0)
        *ret_found = found;
    return rc;
}

int orl_session_row_remove(struct orl_db *db, const char *hash, bool all, struct orl_error *err)
{
    return orl_db_run(db, err, NULL,
                      all ? "DELETE FROM sessions WHERE token = (SELECT token FROM sessions WHERE "
                            "hash = ?)"
                          : "DELETE FROM sessions WHERE hash = ?",
                      "s", hash);
}
