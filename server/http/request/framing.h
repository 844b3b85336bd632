/*
 * The target host and the end of a request, by its headers (RFC 9112, 3.2 and 6.3). A request that
 * the daemon and a proxy in front could read differently is refused, since one request could hide
 * inside another (11.2). Threads: loop.
 */
#ifndef ORL_SERVER_HTTP_REQUEST_FRAMING_H
#define ORL_SERVER_HTTP_REQUEST_FRAMING_H

#include <microhttpd.h>
#include <stdbool.h>

/* Returns NULL, or the sentence of the refusal. method and version are MHD's. */
const char *orl_framing_check(struct MHD_Connection *connection, const char *method,
                              const char *version);

/*
 * Called from MHD's callback for a request's target, before the arguments are parsed. If the target
 * and the space for its arguments exceed ORL_SERVER_URI_BYTES, cuts the query off and returns true.
 * libmicrohttpd 0.9 does not answer a request whose arguments do not fit.
 */
bool orl_framing_cut_query(const char *uri);

/* Unescapes a part of a target, for MHD's callback. It works like MHD's own function, but keeps
 * %00, which would end the text early. Returns the length. */
size_t orl_framing_unescape(char *text);

#endif
