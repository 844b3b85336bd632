/*
 * Access tokens: creation and recognition.
 *
 *     oriel_0123456789abcdef_<43 characters of base64url>
 *           the id           the secret: 32 random bytes
 *
 * The secret is shown once and not stored; its row holds an unkeyed BLAKE2b-256. That is enough:
 * 256 random bits cannot be guessed, however fast the hash is. The hash is compared in constant
 * time.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_TOKENS_H
#define ORL_SERVER_HTTP_ACCESS_TOKENS_H

#include "store/rows/stored_tokens.h"

enum { ORL_TOKEN_TEXT = 80 };

/* Makes a token. name: up to 64 letters, digits, '-', '_', '.'. Fills the row, but does not write
 * it to the database. */
int orl_token_make(const char *name, enum orl_token_scope scope, struct orl_token_row *ret_row,
                   char ret_text[ORL_TOKEN_TEXT], struct orl_error *err);

/* Returns the row of a token. statement: orl_token_find_statement's. *ret_known is false for a
 * token that never existed or has been removed. */
int orl_token_verify(struct orl_db *db, sqlite3_stmt *statement, const char *text,
                     struct orl_token_row *ret_row, bool *ret_known, struct orl_error *err);

#endif
