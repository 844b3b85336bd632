/*
 * Signed links to one file of one job's results, for clients that cannot send a token: <img>,
 * downloads.
 *
 *     /v1/jobs/ID/files/north.png?by=0123456789abcdef&until=1711107000&signature=<43 of base64url>
 *                                    a token's id     s since 1970
 *
 * The signature is a keyed BLAKE2b-256 over job, file, time, and the id and hash of the token, by
 * the key of link_key.h. A link gives access to that file alone, until its time is over or the
 * token is removed. The daemon stores no links. It refuses a time more than ORL_SERVER_LINK_S
 * ahead, even with a valid signature.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_SIGNED_LINKS_H
#define ORL_SERVER_HTTP_ACCESS_SIGNED_LINKS_H

#include "http/request/request.h"

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
