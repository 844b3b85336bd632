/*
 * Access control of requests: tokens, owners and pages of other origins (access.c), browsers'
 * sessions (sessions.c), and signed links with their key (signed_links.c).
 */
#ifndef ORL_SERVER_HTTP_ACCESS_ACCESS_H
#define ORL_SERVER_HTTP_ACCESS_ACCESS_H

#include "http/request/request.h"
#include "store/files/folders.h"
#include "store/rows/stored_tokens.h"

/*
 * Tokens and owners. Without tokens, any program of this machine may use the daemon, and web pages
 * are kept out (origin_policy.h). Tokens are required when other machines can reach the daemon.
 * Threads: the loop thread only.
 */

/* Checks the origin, before the route is known. Returns false, with a 403 made, for another site's
 * page. Fills request->cross_origin. */
bool orl_access_check_origin(struct orl_request *request);

/*
 * Checks that the request's token has the scope of the route. The Authorization header carries the
 * token. Without that header, a signed link or a session's cookie may stand for a token. Otherwise
 * returns false, with a 401 or 403 made (RFC 6750). Fills request->token with the token's name, and
 * request->token_row.
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

/*
 * Pages of other origins (--allow-origin), by the CORS protocol of the Fetch standard: preflight
 * requests, and headers on every answer.
 *
 * Access-Control-Allow-Origin names the one origin, never "*". Access-Control-Allow-Credentials is
 * never sent: such a page sends a token itself, and no cookie. The answers vary by Origin (Vary).
 * Threads: the loop thread only.
 */

/* Answers a preflight OPTIONS. allow: the route's methods ("GET, HEAD"). Returns true, with a 204
 * made; false if it is not a preflight or its origin is not allowed. */
bool orl_cors_preflight(struct orl_request *request, const char *allow);

/* Adds the headers to the response made. */
void orl_cors_add(struct orl_request *request);

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

/*
 * The key of signed links: 32 random bytes in the data folder's file oriel.key,
 * which only its owner can read. It is not in the database or in a backup, so copies of these are
 * not enough to sign a link. A data folder without the file, such as one restored from a backup,
 * gets a new key. Links that were signed before are then invalid.
 */

enum { ORL_LINK_KEY_BYTES = 32 };

/* Reads the key, or makes one. If a new key cannot be stored, as on a full disk, it is valid until
 * the daemon ends. */
int orl_link_key_open(const struct orl_folders *folders, unsigned char ret_key[ORL_LINK_KEY_BYTES],
                      struct orl_error *err);

/*
 * Signed links to one file of one job's results, for clients that cannot send a token: <img>,
 * downloads.
 *
 *     /v1/jobs/ID/files/north.png?by=0123456789abcdef&until=1711107000&signature=<43 of base64url>
 *                                    a token's id     s since 1970
 *
 * The signature is a keyed BLAKE2b-256 over job, file, time, and the id and hash of the token, by
 * the key above. A link gives access to that file alone, until its time is over or the
 * token is removed. The daemon stores no links. It refuses a time more than ORL_SERVER_LINK_S
 * ahead, even with a valid signature.
 *
 * Threads: the loop thread only.
 */

enum { ORL_LINK_ARGUMENTS = 128 };

/* Writes the arguments of a link, "by=...", signed for the request's token. */
void orl_link_sign(const struct orl_request *request, const char *job, const char *file,
                   int64_t until_s, char ret_arguments[ORL_LINK_ARGUMENTS]);

/* Returns true if the request has a signature. */
bool orl_link_is_present(const struct orl_request *request);
/* Returns the token of the request's link. *ret_good is false if the signature does not match or
 * the link has expired. */
int orl_link_check(const struct orl_request *request, struct orl_token_row *ret_token,
                   bool *ret_good, struct orl_error *err);

#endif
