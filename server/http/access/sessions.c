#include "http/access/access.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "http/access/origin_policy.h"
#include "http/context.h"
#include "process/limits.h"
#include "process/times.h"

enum { SECRET_BYTES = 32, SECRET_TEXT = 44, HASH_BYTES = 32, NAME = 40 };

static bool is_secure(const struct orl_request *request)
{
    const char *proto = orl_request_header(request, "X-Forwarded-Proto");
    return request->context->config->tls_cert || (proto && strcasecmp(proto, "https") == 0);
}

static void format_cookie_name(const struct orl_request *request, char ret_name[NAME])
{
    const struct orl_config *config = request->context->config;
    const unsigned port = config->address.any.sa_family == AF_INET6
                              ? ntohs(config->address.v6.sin6_port)
                              : ntohs(config->address.v4.sin_port);
    snprintf(ret_name, NAME, "%soriel-%u", is_secure(request) ? "__Host-" : "", port);
}

static void write_cookie(const struct orl_request *request, const char *value, unsigned age_s,
                         char ret_cookie[ORL_SESSION_COOKIE])
{
    char name[NAME];
    format_cookie_name(request, name);
    snprintf(ret_cookie, ORL_SESSION_COOKIE,
             "%s=%s; Path=/; HttpOnly; SameSite=Strict%s; Max-Age=%u", name, value,
             is_secure(request) ? "; Secure" : "", age_s);
}

static void hash_secret(const char *secret, char ret_hash[ORL_SESSION_HASH])
{
    unsigned char hash[HASH_BYTES];
    crypto_generichash(hash, sizeof hash, (const unsigned char *)secret, strlen(secret), NULL, 0);
    sodium_bin2hex(ret_hash, ORL_SESSION_HASH, hash, sizeof hash);
}

/* Reads the cookie. Returns false if there is none with a valid form. */
static bool read_cookie(const struct orl_request *request, char ret_hash[ORL_SESSION_HASH])
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    char name[NAME];
    format_cookie_name(request, name);
    const char *value = MHD_lookup_connection_value(request->connection, MHD_COOKIE_KIND, name);
    if (!value || strlen(value) != SECRET_TEXT - 1 || value[strspn(value, allowed)])
        return false;
    hash_secret(value, ret_hash);
    return true;
}

int orl_session_find(struct orl_request *request, struct orl_session_row *ret_row, bool *ret_found,
                     struct orl_error *err)
{
    char hash[ORL_SESSION_HASH];
    *ret_found = false;
    if (request->cross_origin || !read_cookie(request, hash))
        return 0;
    return orl_session_row_find(request->context->db, hash, orl_time_now_ms(), ret_row, ret_found,
                                err);
}

const char *orl_session_refusal(const struct orl_request *request)
{
    const bool reads = strcmp(request->method, "GET") == 0 || strcmp(request->method, "HEAD") == 0;
    if (!orl_fetch_site_is_own(orl_request_header(request, "Sec-Fetch-Site")))
        return "it comes from a web page of another site";
    if (!reads && !orl_request_header(request, MHD_HTTP_HEADER_ORIGIN))
        return "it does not say which web page it comes from (Origin), and has no token";
    return NULL;
}

int orl_session_begin(struct orl_request *request, const struct orl_token_row *token,
                      char ret_cookie[ORL_SESSION_COOKIE], int64_t *ret_expires_ms,
                      struct orl_error *err)
{
    unsigned char secret[SECRET_BYTES];
    char text[SECRET_TEXT], hash[ORL_SESSION_HASH];
    const int64_t now_ms = orl_time_now_ms();
    randombytes_buf(secret, sizeof secret);
    sodium_bin2base64(text, sizeof text, secret, sizeof secret,
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    hash_secret(text, hash);
    *ret_expires_ms = now_ms + 1000 * (int64_t)ORL_SERVER_SESSION_S;
    const int rc = orl_session_row_insert(request->context->db, hash, token->id, now_ms,
                                          *ret_expires_ms, ORL_SERVER_SESSIONS, err);
    if (rc == 0)
        write_cookie(request, text, ORL_SERVER_SESSION_S, ret_cookie);
    sodium_memzero(text, sizeof text);
    return rc;
}

int orl_session_end(struct orl_request *request, bool all, char ret_cookie[ORL_SESSION_COOKIE],
                    struct orl_error *err)
{
    char hash[ORL_SESSION_HASH];
    write_cookie(request, "", 0, ret_cookie);
    return read_cookie(request, hash) ? orl_session_row_remove(request->context->db, hash, all, err)
                                      : 0;
}
