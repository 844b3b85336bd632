/* /v1/session: signs a browser in with a token, reports its session, and signs it out. */
#include "handlers/handlers.h"

#include <jansson.h>
#include <string.h>

#include "http/access/access.h"
#include "http/context.h"
#include "http/response/reply.h"
#include "process/times.h"

/* {"needed", "signed_in", "token", "scope", "expires"} */
static json_t *session_to_json(bool needed, const struct orl_token_row *token, int64_t expires_ms)
{
    char expires[ORL_TIME_TEXT];
    orl_time_format(expires_ms, expires);
    return json_pack("{s:b, s:b, s:s?, s:s?, s:s?}", "needed", needed, "signed_in", token != NULL,
                     "token", token ? token->name : NULL, "scope",
                     token ? orl_scope_name(token->scope) : NULL, "expires",
                     token ? expires : NULL);
}

void orl_handle_session_get(struct orl_request *request)
{
    const bool needed = request->context->config->needs_token;
    struct orl_session_row session;
    struct orl_error err;
    bool found = false;
    if (needed && orl_session_find(request, &session, &found, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_json(
        request, 200,
        session_to_json(needed, found ? &session.token : NULL, found ? session.expires_ms : 0));
    orl_reply_header(request, "Cache-Control", "no-store");
}

void orl_handle_session_post(struct orl_request *request)
{
    char cookie[ORL_SESSION_COOKIE];
    int64_t expires_ms = 0;
    struct orl_error err;
    if (!request->context->config->needs_token) {
        orl_reply_problem(request, 409, "not-needed", "Signing in is not needed",
                          "this daemon does not require tokens");
        return;
    }
    /* A session may not create another one, so a stolen cookie is valid for its own time only. */
    if (!orl_request_header(request, MHD_HTTP_HEADER_AUTHORIZATION)) {
        orl_access_refuse(request, false);
        return;
    }
    if (orl_session_begin(request, &request->token_row, cookie, &expires_ms, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_json(request, 201, session_to_json(true, &request->token_row, expires_ms));
    orl_reply_header(request, "Set-Cookie", cookie);
    orl_reply_header(request, "Cache-Control", "no-store");
    orl_reply_when_durable(request);
}

void orl_handle_session_delete(struct orl_request *request)
{
    const char *all = orl_request_query(request, "all");
    char cookie[ORL_SESSION_COOKIE];
    struct orl_session_row session;
    struct orl_error err;
    bool found = false;
    int rc = request->context->config->needs_token
                 ? orl_session_find(request, &session, &found, &err)
                 : 0;
    const char *refusal = found ? orl_session_refusal(request) : NULL;
    if (refusal) {
        orl_reply_problem(request, 403, "forbidden", "The request is refused", "%s", refusal);
        return;
    }
    if (rc == 0)
        rc = orl_session_end(request, all && strcmp(all, "true") == 0, cookie, &err);
    if (rc) {
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_no_content(request);
    orl_reply_header(request, "Set-Cookie", cookie);
    orl_reply_when_durable(request);
}
