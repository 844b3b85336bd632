#include "http/access/tokens.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "process/times.h"

enum { SECRET_BYTES = 32, SECRET_TEXT = 44, HASH_BYTES = 32, ID_BYTES = 8 };
static const char prefix[] = "oriel_";
static const int base64 = sodium_base64_VARIANT_URLSAFE_NO_PADDING;

static void hash_secret(const char *secret, unsigned char ret_hash[HASH_BYTES])
{
    crypto_generichash(ret_hash, HASH_BYTES, (const unsigned char *)secret, strlen(secret), NULL,
                       0);
}

int orl_token_make(const char *name, enum orl_token_scope scope, struct orl_token_row *ret_row,
                   char ret_text[ORL_TOKEN_TEXT], struct orl_error *err)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                  "-_.";
    unsigned char id[ID_BYTES], secret[SECRET_BYTES], hash[HASH_BYTES];
    char text[SECRET_TEXT];
    struct orl_token_row row = {.scope = scope, .created_ms = orl_time_now_ms()};
    const size_t length = strlen(name);
    if (length == 0 || length >= sizeof row.name || name[strspn(name, allowed)])
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a token's name has 1 to %d letters, digits, '-', '_' or '.'",
                             ORL_TOKEN_NAME - 1);
    memcpy(row.name, name, length + 1);
    randombytes_buf(id, sizeof id);
    randombytes_buf(secret, sizeof secret);
    sodium_bin2hex(row.id, sizeof row.id, id, sizeof id);
    sodium_bin2base64(text, sizeof text, secret, sizeof secret, base64);
    hash_secret(text, hash);
    sodium_bin2hex(row.hash, sizeof row.hash, hash, sizeof hash);
    snprintf(ret_text, ORL_TOKEN_TEXT, "%s%s_%s", prefix, row.id, text);
    *ret_row = row;
    return 0;
}

int orl_token_verify(struct orl_db *db, sqlite3_stmt *statement, const char *text,
                     struct orl_token_row *ret_row, bool *ret_known, struct orl_error *err)
{
    const size_t head = sizeof prefix - 1, id = ORL_TOKEN_ID - 1;
    unsigned char given[HASH_BYTES], kept[HASH_BYTES] = {0};
    struct orl_token_row row;
    char name[ORL_TOKEN_ID];
    bool found = false;
    *ret_known = false;
    if (strncmp(text, prefix, head) != 0 || strlen(text) != head + id + SECRET_TEXT ||
        text[head + id] != '_')
        return 0;
    snprintf(name, sizeof name, "%.*s", (int)id, text + head);
    const int rc = orl_token_row_find(db, statement, name, &row, &found, err);
    if (rc || !found)
        return rc;
    hash_secret(text + head + id + 1, given);
    if (sodium_hex2bin(kept, sizeof kept, row.hash, strlen(row.hash), NULL, NULL, NULL) != 0 ||
        sodium_memcmp(given, kept, sizeof kept) != 0)
        return 0;
    *ret_row = row;
    *ret_known = true;
    return 0;
}
