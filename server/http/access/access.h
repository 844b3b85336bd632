/*
 * Access control of requests. Without tokens, any program of this machine may use the daemon, and
 * web pages are kept out (origin_policy.h). Tokens are required when other machines can reach the
 * daemon. Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_ACCESS_H
#define ORL_SERVER_HTTP_ACCESS_ACCESS_H

#include "http/request/request.h"
#include "store/rows/stored_sessions.h"

/* Checks the origin, before the route is known. Returns false, with a 403 made, for another site's
 * page. Fills request->cross_origin. */
bool orl_access_check_origin(struct orl_request *request);

/*
 * Checks that the request's token has the scope of the route. The Authorization header carries the
 * token. Without that header, a signed link (signed_links.h) or a cookie (sessions.h) may stand for
 * a token. Otherwise returns false, with a 401 or 403 made (RFC 6750). Fills request->token with
 * the token's name, and request->holder.
 */
bool orl_access_check_token(struct orl_request *request);

/* Returns the owner of new objects that the request submits: the id of its token; "" if tokens are
 * not required. */
const char *orl_access_owner(const struct orl_request *request);
/* Checks that the request may change objects of that owner. It may if tokens are not required, with
 * the owner's own token, or with scope admin. Otherwise returns false, with a 403 made. */
bool orl_access_check_owner(struct orl_request *request, const char *owner);

/* The credentials that admitted a request, kept for work that outlives its headers. */
struct orl_credentials {
    char token[ORL_TOKEN_ID];       /* "": tokens are not required */
    char session[ORL_SESSION_HASH]; /* "": the token itself was sent */
};
/* Returns the credentials of a request that was not admitted by a link. */
struct orl_credentials orl_access_credentials(struct orl_request *request);
/* Returns true if the credentials are still valid, or if the database cannot be read. */
bool orl_access_is_valid(struct orl_http_context *context,
                         const struct orl_credentials *credentials);

/* Makes a 401: the token is missing or unknown. Returns false. */
bool orl_access_refuse(struct orl_request *request, bool has_token);

#endif
