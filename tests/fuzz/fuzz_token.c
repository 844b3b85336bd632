/*
 * Access tokens as clients send them. If the first byte is odd, the token is the rest of the
 * input. Otherwise the rest is edits of a valid token: pairs of place and new byte; places past
 * the end append. A token is recognised exactly if it equals the valid one.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "http/access/tokens.h"
#include "store/database/db.h"

enum { MOST = 256 };

/* These are set up once, by need_token(). */
static struct orl_db db;
static sqlite3_stmt *statement;
static char good[ORL_TOKEN_TEXT];

static void need_token(void)
{
    struct orl_token_row row;
    if (statement)
        return;
    FUZZ_PROMISE(orl_db_open(&db, ":memory:", NULL) == 0);
    FUZZ_PROMISE(orl_db_migrate_embedded(&db, NULL) == 0);
    FUZZ_PROMISE(orl_token_make("someone", ORL_SCOPE_READ, &row, good, NULL) == 0);
    FUZZ_PROMISE(orl_token_row_insert(&db, &row, NULL) == 0);
    statement = orl_token_find_statement(&db, NULL);
    FUZZ_PROMISE(statement != NULL);
}

static void edit(char text[MOST + 1], const uint8_t *data, size_t size)
{
    size_t length = strlen(text);
    for (size_t i = 0; i + 2 <= size; i += 2) {
        if (data[i] < length)
            text[data[i]] = (char)data[i + 1];
        else if (length < MOST)
            text[length++] = (char)data[i + 1];
    }
}

bool fuzz_token(const uint8_t *data, size_t size)
{
    char text[MOST + 1] = "";
    struct orl_token_row row = {.name = "nobody"};
    struct orl_error err = {0};
    bool known = true;
    need_token();
    if (size > 0 && data[0] % 2 == 1) {
        memcpy(text, data + 1, size - 1 < MOST ? size - 1 : MOST);
    } else {
        memcpy(text, good, sizeof good);
        edit(text, data + (size > 0), size - (size > 0));
    }
    const int code = orl_token_verify(&db, statement, text, &row, &known, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    FUZZ_PROMISE(code == 0 && known == (strcmp(text, good) == 0));
    FUZZ_PROMISE(strcmp(row.name, known ? "someone" : "nobody") == 0);
    return known;
}
