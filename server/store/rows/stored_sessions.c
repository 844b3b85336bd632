#include "store/rows/stored_sessions.h"

#include <stdio.h>

static int insert_row(struct orl_db *db, const char *hash, const char *token_id, int64_t now_ms,
                      int64_t expires_ms, unsigned most, struct orl_error *err)
{
    int rc = orl_db_run(db, err, NULL, "DELETE FROM sessions WHERE expires_ms <= ?", "i", now_ms);
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
    return rc;
}

int orl_session_row_insert(struct orl_db *db, const char *hash, const char *token_id,
                           int64_t now_ms, int64_t expires_ms, unsigned most, struct orl_error *err)
{
    int rc = orl_db_begin(db, err);
    if (rc)
        return rc;
    rc = insert_row(db, hash, token_id, now_ms, expires_ms, most, err);
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
    if (!stmt)
        return ORL_ERR_IO;
    int rc = 0;
    const int step = sqlite3_step(stmt);
    if (step == SQLITE_ROW) {
        snprintf(ret_row->hash, sizeof ret_row->hash, "%s", hash);
        ret_row->token = orl_token_row_read(stmt);
        ret_row->expires_ms = sqlite3_column_int64(stmt, 5);
    } else if (step != SQLITE_DONE) {
        rc = orl_db_error(db, "cannot read sessions", err);
    }
    sqlite3_finalize(stmt);
    if (rc == 0)
        *ret_found = step == SQLITE_ROW;
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
