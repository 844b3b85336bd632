#include "http/access/access.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <arpa/inet.h>

#include "http/access/origin_policy.h"
#include "http/access/tokens.h"
#include "http/context.h"
#include "http/request/parse_request.h"
#include "http/response/reply.h"
#include "process/times.h"

static bool is_forwarded(const struct orl_request *request)
{
    static const char *const names[] = {"Forwarded",         "Via",
                                        "X-Forwarded-For",   "X-Forwarded-Host",
                                        "X-Forwarded-Proto", "X-Real-IP"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (orl_request_header(request, names[i]))
            return true;
    return false;
}

/* Returns true if the daemon's own pages may use that scheme. Behind a TLS proxy the scheme is
 * X-Forwarded-Proto; without that header either scheme may be. */
static bool is_own_scheme(const struct orl_request *request, bool https)
{
    const struct orl_config *config = request->context->config;
    const char *proto = orl_request_header(request, "X-Forwarded-Proto");
    if (config->tls_cert || !config->needs_token)
        return https == (config->tls_cert != NULL);
    return !proto || (strcasecmp(proto, "https") == 0) == https;
}

static bool has_header_value(const struct orl_request *request, const char *header,
                             const char *value)
{
    const char *found = orl_request_header(request, header);
    return found && strcasecmp(found, value) == 0;
}

/* Returns true for a browser's top-level navigation to "/" by its Fetch Metadata headers: not a
 * frame, image or script. */
static bool follows_link(const struct orl_request *request)
{
    const char *accept = orl_request_header(request, MHD_HTTP_HEADER_ACCEPT);
    return strcmp(request->method, "GET") == 0 && strcmp(request->path, "/") == 0 &&
           has_header_value(request, "Sec-Fetch-Mode", "navigate") &&
           has_header_value(request, "Sec-Fetch-Dest", "document") &&
           orl_negotiate_weight(accept, "text/html") > 0;
}

/* Checks the headers against origin_policy.h. host: the authority of an absolute-form target,
 * otherwise the Host header. */
static const char *check_origin_policy(struct orl_request *request, const char *host)
{
    const struct orl_config *config = request->context->config;
    const struct orl_origin_policy_input policy_input = {
        .host = host,
        .origin = orl_request_header(request, MHD_HTTP_HEADER_ORIGIN),
        .fetch_site = orl_request_header(request, "Sec-Fetch-Site"),
        .forwarded = is_forwarded(request),
        .follows_link = follows_link(request),
        .tokens = config->needs_token,
        .http = is_own_scheme(request, false),
        .https = is_own_scheme(request, true),
        .allowed = config->origins,
        .n_allowed = config->n_origins,
    };
    return orl_origin_policy_check(&policy_input, &request->cross_origin);
}

/* Checks a target in absolute form. Its scheme must be the daemon's. The Host header, which should
 * be identical, must not name another machine either. */
static const char *check_target(struct orl_request *request, const char *host)
{
    if (!is_own_scheme(request, request->target.https))
        return "its target's scheme is not the one of the connection";
    if (!request->context->config->needs_token && host && !orl_host_is_loopback(host))
        return "the Host header is not a name of this machine";
    return check_origin_policy(request, request->target.authority);
}

bool orl_access_check_origin(struct orl_request *request)
{
    const char *host = orl_request_header(request, MHD_HTTP_HEADER_HOST);
    const char *refusal = request->target.authority[0] ? check_target(request, host)
                                                       : check_origin_policy(request, host);
    if (refusal)
        orl_reply_problem(request, 403, "forbidden", "The request is refused", "%s", refusal);
    return !refusal;
}

/* ---- Tokens and owners ----------------------------------------------------------------------- */

static void log_refusal(struct orl_request *request, const char *why)
{
    char peer[80] = "-";
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    if (info && info->client_addr)
        orl_address_format(info->client_addr, peer, sizeof peer);
    orl_log_event(request->context->log, ORL_LOG_WARN, "refused", "isss", "id",
                  (int64_t)request->id, "peer", peer, "token", request->token, "why", why);
}

bool orl_access_refuse(struct orl_request *request, bool has_token)
{
    orl_reply_problem(
        request, 401, "unauthorized", "An access token is needed", "%s",
        has_token
            ? "the daemon does not know this token, or it was removed"
            : "send an access token as Authorization: Bearer ($ORIEL_TOKEN for oriel); `orield "
              "token add` makes one");
    orl_reply_header(request, "WWW-Authenticate",
                     has_token ? "Bearer realm=\"oriel\", error=\"invalid_token\""
                               : "Bearer realm=\"oriel\"");
    log_refusal(request, has_token ? "unknown token" : "no token");
    return false;
}

static bool refuse_scope(struct orl_request *request, enum orl_token_scope wanted, const char *what)
{
    const char *needs = orl_scope_name(wanted);
    char challenge[96];
    orl_reply_problem(request, 403, "insufficient-scope", "The token does not allow this",
                      "%s requires a token of scope %s; the one sent has %s", what, needs,
                      orl_scope_name(request->token_row.scope));
    snprintf(challenge, sizeof challenge,
             "Bearer realm=\"oriel\", error=\"insufficient_scope\", scope=\"%s\"", needs);
    orl_reply_header(request, "WWW-Authenticate", challenge);
    log_refusal(request, "scope");
    return false;
}

/* Refuses a request with a 403 that no other token would change. */
static bool refuse_request(struct orl_request *request, const char *why)
{
    orl_reply_problem(request, 403, "forbidden", "The request is refused", "%s", why);
    log_refusal(request, why);
    return false;
}

/* Identifies the token by the Authorization header. Returns false after a reply. */
static bool identify_by_token(struct orl_request *request, const char *header)
{
    static const char scheme[] = "Bearer ";
    struct orl_error err;
    bool known = false;
    if (strncasecmp(header, scheme, sizeof scheme - 1) != 0)
        return orl_access_refuse(request, false);
    if (orl_token_verify(request->context->db, request->context->token_statement,
                         header + sizeof scheme - 1, &request->token_row, &known, &err)) {
        orl_reply_error(request, &err);
        return false;
    }
    return known || orl_access_refuse(request, true);
}

/* Identifies the token by a cookie. *ret_refusal is set if there is a valid cookie that may not be
 * used. */
static int identify_by_session(struct orl_request *request, bool *ret_known,
                               const char **ret_refusal, struct orl_error *err)
{
    struct orl_session_row session;
    bool found = false;
    const int rc = orl_session_find(request, &session, &found, err);
    if (rc || !found)
        return rc;
    *ret_refusal = orl_session_refusal(request);
    *ret_known = !*ret_refusal;
    request->token_row = session.token;
    return 0;
}

/* Identifies the token by a signed link, whichever page shows it. Otherwise by a cookie, which the
 * browser may have sent as well. */
static bool identify_by_link_or_session(struct orl_request *request)
{
    const bool shown = orl_link_is_present(request);
    const char *refusal = shown ? "the link was changed, or has expired" : NULL;
    struct orl_error err;
    bool known = false;
    int rc = shown ? orl_link_check(request, &request->token_row, &known, &err) : 0;
    if (rc == 0 && !known)
        rc = identify_by_session(request, &known, &refusal, &err);
    if (rc) {
        orl_reply_error(request, &err);
        return false;
    }
    return known ||
           (refusal ? refuse_request(request, refusal) : orl_access_refuse(request, false));
}

bool orl_access_check_token(struct orl_request *request)
{
    if (!request->context->config->needs_token || request->route->scope == ORL_SCOPE_OPEN)
        return true;
    const char *header = orl_request_header(request, MHD_HTTP_HEADER_AUTHORIZATION);
    if (!(header ? identify_by_token(request, header) : identify_by_link_or_session(request)))
        return false;
    snprintf(request->token, sizeof request->token, "%s", request->token_row.name);
    return request->token_row.scope >= request->route->scope ||
           refuse_scope(request, request->route->scope, "this request");
}

const char *orl_access_owner(const struct orl_request *request)
{
    return request->context->config->needs_token ? request->token_row.id : "";
}

bool orl_access_check_owner(struct orl_request *request, const char *owner)
{
    return !request->context->config->needs_token || request->token_row.scope >= ORL_SCOPE_ADMIN ||
           (owner[0] && strcmp(owner, request->token_row.id) == 0) ||
           refuse_scope(request, ORL_SCOPE_ADMIN, "a job of another token");
}

struct orl_credentials orl_access_credentials(struct orl_request *request)
{
    struct orl_credentials credentials = {.token = ""};
    struct orl_session_row session = {.hash = "none"}; /* the session may just have ended */
    struct orl_error err;
    bool found = false;
    memcpy(credentials.token, request->token_row.id, sizeof credentials.token);
    if (!credentials.token[0] || orl_request_header(request, MHD_HTTP_HEADER_AUTHORIZATION))
        return credentials;
    orl_session_find(request, &session, &found, &err);
    memcpy(credentials.session, session.hash, sizeof credentials.session);
    return credentials;
}

bool orl_access_is_valid(struct orl_http_context *context,
                         const struct orl_credentials *credentials)
{
    struct orl_session_row session;
    struct orl_token_row token;
    struct orl_error err;
    bool found = true;
    int rc = 0;
    if (credentials->session[0])
        rc = orl_session_row_find(context->db, credentials->session, orl_time_now_ms(), &session,
                                  &found, &err);
    else if (credentials->token[0])
        rc = orl_token_row_find(context->db, context->token_statement, credentials->token, &token,
                                &found, &err);
    return rc || found;
}

/* ---- Pages of other origins (CORS) ----------------------------------------------------------- */

bool orl_cors_preflight(struct orl_request *request, const char *allow)
{
    if (!request->cross_origin || strcmp(request->method, MHD_HTTP_METHOD_OPTIONS) != 0 ||
        !orl_request_header(request, "Access-Control-Request-Method"))
        return false;
    const char *private = orl_request_header(request, "Access-Control-Request-Private-Network");
    orl_reply_no_content(request);
    orl_reply_header(request, "Access-Control-Allow-Methods", allow);
    orl_reply_header(request, "Access-Control-Allow-Headers",
                     "Authorization, Content-Type, Idempotency-Key, If-None-Match, If-Range, "
                     "Last-Event-ID, Range, X-Oriel-Client");
    orl_reply_header(request, "Access-Control-Max-Age", "600");
    /* A page from a public network may call a daemon on loopback (Private Network Access). */
    if (private && strcasecmp(private, "true") == 0)
        orl_reply_header(request, "Access-Control-Allow-Private-Network", "true");
    return true;
}

void orl_cors_add(struct orl_request *request)
{
    if (request->context->config->n_origins == 0)
        return;
    orl_reply_header(request, "Vary", "Origin");
    if (!request->cross_origin)
        return;
    orl_reply_header(request, "Access-Control-Allow-Origin",
                     orl_request_header(request, MHD_HTTP_HEADER_ORIGIN));
    orl_reply_header(request, "Access-Control-Expose-Headers",
                     "Accept-Ranges, Content-Range, ETag, Link, Location, Retry-After, "
                     "WWW-Authenticate, X-Request-Id");
}
