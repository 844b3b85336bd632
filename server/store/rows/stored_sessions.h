/*
 * Rows of browsers' sessions (http/access/sessions.h). A session whose token was removed, or whose
 * time is over, is not found. Loop thread only.
 */
#ifndef ORL_SERVER_STORE_ROWS_STORED_SESSIONS_H
#define ORL_SERVER_STORE_ROWS_STORED_SESSIONS_H

#include "store/rows/stored_tokens.h"

enum { ORL_SESSION_HASH = 65 };

struct orl_session_row {
    char hash[ORL_SESSION_HASH]; /* digest of the cookie's secret, hexadecimal */
    struct orl_token_row token;  /* token of the session */
    int64_t expires_ms;
};

/* Inserts a session. Removes expired sessions and, beyond `most`, the token's oldest. */
int orl_session_row_insert(struct orl_db *db, const char *hash, const char *token_id,
                           int64_t now_ms, int64_t expires_ms, unsigned most,
                           struct orl_error *err);
int orl_session_row_find(struct orl_db *db, const char *hash, int64_t now_ms,
                         struct orl_session_row *ret_row, bool *ret_found, struct orl_error *err);
/* Removes that session or, with all, every session of its token. There may be none. */
int orl_session_row_remove(struct orl_db *db, const char *hash, bool all, struct orl_error *err);

#endif
