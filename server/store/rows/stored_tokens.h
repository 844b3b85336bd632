/*
 * Rows of access tokens, and of browsers' sessions. The daemon reads the tokens. `orield token`
 * writes them, also while a daemon runs on the same folder; SQLite's locks allow that. Threads:
 * those of the database.
 */
#ifndef ORL_SERVER_STORE_ROWS_STORED_TOKENS_H
#define ORL_SERVER_STORE_ROWS_STORED_TOKENS_H

#include <stdbool.h>

#include "store/database/db.h"

/* The rights of a token: each scope includes those before it. */
enum orl_token_scope {
    ORL_SCOPE_OPEN,   /* no token is needed */
    ORL_SCOPE_READ,   /* read everything */
    ORL_SCOPE_SUBMIT, /* upload, submit and cancel */
    ORL_SCOPE_ADMIN,  /* change or delete what others use */
    ORL_SCOPE_COUNT
};
const char *orl_scope_name(enum orl_token_scope scope);
/* Returns ORL_SCOPE_COUNT if a token can have no such scope. */
enum orl_token_scope orl_scope_from_name(const char *name);

enum { ORL_TOKEN_NAME = 65, ORL_TOKEN_ID = 17, ORL_TOKEN_HASH = 65 };

struct orl_token_row {
    char name[ORL_TOKEN_NAME];
    char id[ORL_TOKEN_ID];     /* hexadecimal */
    char hash[ORL_TOKEN_HASH]; /* digest of the secret, hexadecimal */
    enum orl_token_scope scope;
    int64_t created_ms;
};

/* Inserts a row. ORL_ERR_INVALID if the name is taken. */
int orl_token_row_insert(struct orl_db *db, const struct orl_token_row *row, struct orl_error *err);
/* Removes a row. ORL_ERR_NOT_FOUND if there is none of that name. */
int orl_token_row_remove(struct orl_db *db, const char *name, struct orl_error *err);

/* Returns the statement that finds rows. It is prepared once, since every request may need it. The
 * caller owns it and must finalize it before the database is closed; NULL on failure. */
sqlite3_stmt *orl_token_find_statement(struct orl_db *db, struct orl_error *err);
int orl_token_row_find(struct orl_db *db, sqlite3_stmt *statement, const char *id,
                       struct orl_token_row *ret_row, bool *ret_found, struct orl_error *err);

/* Calls visit for every token, by name. Stops when visit returns non-zero, and returns that. */
int orl_token_rows(struct orl_db *db, int (*visit)(void *ctx, const struct orl_token_row *row),
                   void *ctx, struct orl_error *err);

/*
 * Rows of browsers' sessions (http/access/access.h). A session whose token was removed, or whose
 * time is over, is not found. Loop thread only.
 */

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
