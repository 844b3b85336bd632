#include "http/links.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/context.h"
#include "http/router.h"
#include "process/times.h"

enum { MAC_BYTES = 32, MAC_TEXT = 44, KEY_BYTES = 32 };

static void sign(const struct orl_token_row *token, const char *job, const char *file,
                 int64_t until_s, char ret_signature[MAC_TEXT])
{
    unsigned char key[KEY_BYTES] = {0}, mac[MAC_BYTES];
    char text[ORL_PARAM_MAX * 2 + 80];
    /* Neither an id nor a file's name has a line's end in it; file comes last all the same. */
    const int size =
        snprintf(text, sizeof text, "oriel-link 1\n%s\n%lld\n%s", job, (long long)until_s, file);
    sodium_hex2bin(key, sizeof key, token->hash, strlen(token->hash), NULL, NULL, NULL);
    crypto_generichash(mac, sizeof mac, (const unsigned char *)text, (unsigned long long)size, key,
                       sizeof key);
    sodium_bin2base64(ret_signature, MAC_TEXT, mac, sizeof mac,
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    sodium_memzero(key, sizeof key);
}

void orl_link_sign(const struct orl_token_row *token, const char *job, const char *file,
                   int64_t until_s, char ret_arguments[ORL_LINK_ARGUMENTS])
{
    char signature[MAC_TEXT];
    sign(token, job, file, until_s, signature);
    snprintf(ret_arguments, ORL_LINK_ARGUMENTS, "by=%s&until=%lld&signature=%s", token->id,
             (long long)until_s, signature);
}

bool orl_link_is_shown(const struct orl_request *request)
{
    return request->route->by_link && orl_request_query(request, "signature");
}

int orl_link_check(const struct orl_request *request, struct orl_token_row *ret_token,
                   bool *ret_good, struct orl_error *err)
{
    const struct orl_http_context *context = request->context;
    const char *by = orl_request_query(request, "by");
    const char *until = orl_request_query(request, "until");
    const char *signature = orl_request_query(request, "signature");
    char wanted[MAC_TEXT];
    bool found = false;
    *ret_good = false;
    if (!by || strlen(by) != ORL_TOKEN_ID - 1 || !until || !*until || strlen(until) > 15 ||
        until[strspn(until, "0123456789")] || strlen(signature) != MAC_TEXT - 1)
        return 0;
    const int rc =
        orl_token_row_find(context->db, context->token_finder, by, ret_token, &found, err);
    if (rc || !found)
        return rc;
    const int64_t until_s = strtoll(until, NULL, 10);
    sign(ret_token, request->params[0], request->params[1], until_s, wanted);
    *ret_good =
        sodium_memcmp(wanted, signature, MAC_TEXT - 1) == 0 && orl_time_now_ms() < 1000 * until_s;
    return 0;
}
