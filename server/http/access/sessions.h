/*
 * Sign-in of browsers, which do not send tokens by themselves: a token is exchanged once for a
 * cookie.
 *
 *     Set-Cookie: __Host-oriel-8423=<43 characters of base64url>; Path=/; HttpOnly;
 *                 SameSite=Strict; Secure; Max-Age=43200
 *
 * Without TLS, here or at a proxy that reports it (X-Forwarded-Proto), the name is oriel-8423, and
 * the cookie is not Secure. The name contains the port, since browsers send a cookie to every port
 * of its host. The value is 32 random bytes, of which the database keeps a hash. Sessions survive a
 * restart. They end after ORL_SERVER_SESSION_S, with their token, and when they are revoked.
 *
 * A page of another site, or of another port, could have the browser send a request with the
 * cookie. SameSite excludes other sites. A request with the cookie is refused if Sec-Fetch-Site
 * names another origin. A request that changes something is refused without an Origin, which must
 * be the daemon's own (origin_policy.h). Cookies are not accepted from pages of --allow-origin.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_SESSIONS_H
#define ORL_SERVER_HTTP_ACCESS_SESSIONS_H

#include "http/request/request.h"
#include "store/rows/stored_sessions.h"

enum { ORL_SESSION_COOKIE = 320 };

/* Returns the session of the request's cookie. *ret_found is false without a valid cookie. */
int orl_session_find(struct orl_request *request, struct orl_session_row *ret_row, bool *ret_found,
                     struct orl_error *err);

/* Returns NULL, or the reason for refusing a request that has only a cookie. */
const char *orl_session_refusal(const struct orl_request *request);

/* Starts a session of that token. Writes the value of the Set-Cookie header, and the time when the
 * session ends. */
int orl_session_begin(struct orl_request *request, const struct orl_token_row *token,
                      char ret_cookie[ORL_SESSION_COOKIE], int64_t *ret_expires_ms,
                      struct orl_error *err);

/* Ends the request's session, or all sessions of its token. Writes the Set-Cookie value that
 * deletes the cookie. */
int orl_session_end(struct orl_request *request, bool all, char ret_cookie[ORL_SESSION_COOKIE],
                    struct orl_error *err);

#endif
