/*
 * Whether a request may do what it asks: web pages are kept out where anyone on this machine may
 * come in (guard.h), and tokens are asked for where others can reach the daemon.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_H
#define ORL_SERVER_HTTP_ACCESS_H

#include "http/request.h"
#include "store/sessions.h"

/* Before the route is known: false, with a 403 made, for another site's page. Fills
 * request->cross_origin. */
bool orl_access_check_origin(struct orl_request *request);

/*
 * By the route's scope: false, with a 401 or 403 made (RFC 6750), when the Authorization header has
 * no token that may do this, nor, without such a header, a signed link (links.h) or a cookie
 * (sessions.h) speaks for one. Fills request->token with the token's name, and request->holder.
 */
bool orl_access_check_token(struct orl_request *request);

/* Whose is what the request submits: the id of its token; "" where none is needed. */
const char *orl_access_owner(const struct orl_request *request);
/* May the request change what that owner has submitted? Any may where no token is needed, else the
 * owner's own token and those of scope admin. False, with a 403 made. */
bool orl_access_check_owner(struct orl_request *request, const char *owner);

/* What let a request in, for whatever of it goes on when its headers are long forgotten. */
struct orl_admission {
    char token[ORL_TOKEN_ID];       /* "": none was needed */
    char session[ORL_SESSION_HASH]; /* "": the token itself was sent */
};
/* Of one that no link let in. */
struct orl_admission orl_access_admission(struct orl_request *request);
/* Would it do so still? Where the database does not say, yes. */
bool orl_access_holds(struct orl_http_context *context, const struct orl_admission *admission);

/* A 401: there is no token, or an unknown one. Returns false. */
bool orl_access_refuse(struct orl_request *request, bool has_token);

#endif
