/*
 * Sign-in of browsers, which send no token by themselves: a token exchanged once for a cookie.
 *
 *     Set-Cookie: __Host-oriel-8423=<43 characters of base64url>; Path=/; HttpOnly;
 * SameSite=Strict; Secure; Max-Age=43200
 *
 * Without TLS, here or at a proxy that says so (X-Forwarded-Proto), it is oriel-8423, and not
 * Secure. The name has the port, for a cookie is sent to every port of its host. Its value is 32
 * random bytes, of which the database keeps a hash: sessions outlive a restart, end after
 * ORL_SERVER_SESSION_S, with their token, and when they are revoked.
 *
 * Against requests that a page of another site, or of another port, has the browser send with the
 * cookie: SameSite keeps it from other sites' requests; a request with it that Sec-Fetch-Site says
 * another origin's page has made is refused, and so is one that changes something and has no
 * Origin, which has to be the daemon's own (guard.h). Pages of --allow-origin are not heard by a
 * cookie.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_SESSIONS_H
#define ORL_SERVER_HTTP_SESSIONS_H

#include "http/request.h"
#include "store/sessions.h"

enum { ORL_SESSION_COOKIE = 320 };

/* Whose cookie the request has; *ret_found is false without one that is good. */
int orl_session_find(struct orl_request *request, struct orl_session_row *ret_row, bool *ret_found,
                     struct orl_error *err);

/* NULL, or why a request that has nothing but a cookie to show is refused. */
const char *orl_session_refusal(const struct orl_request *request);

/* A new session of that token; the Set-Cookie header's value, and when it ends. */
int orl_session_begin(struct orl_request *request, const struct orl_token_row *token,
                      char ret_cookie[ORL_SESSION_COOKIE], int64_t *ret_expires_ms,
                      struct orl_error *err);

/* Ends the request's session, or all of its token; the header that has the browser forget it. */
int orl_session_end(struct orl_request *request, bool all, char ret_cookie[ORL_SESSION_COOKIE],
                    struct orl_error *err);

#endif
