/*
 * Whose a request is and where it ends, by its headers (RFC 9112, 3.2 and 6.3). What could be read
 * in two ways, by us and by a proxy in front, is refused, lest one request hide inside another
 * (11.2). Threads: loop.
 */
#ifndef ORL_SERVER_HTTP_FRAMING_H
#define ORL_SERVER_HTTP_FRAMING_H

#include <microhttpd.h>
#include <stdbool.h>

/* NULL, or the sentence to refuse it with. Method and version as MHD gives them. */
const char *orl_framing_check(struct MHD_Connection *connection, const char *method,
                              const char *version);

/*
 * Of MHD's callback for a request's target, before its arguments are taken apart: is it longer than
 * ORL_SERVER_URI_BYTES, with what each argument takes? Then the query is cut off: libmicrohttpd 0.9
 * gives a request no answer when there is no room for its arguments.
 */
bool orl_framing_cut_query(const char *uri);

/* Of MHD's callback for parts of a target: as MHD does, but %00, which would end a text before its
 * end, stays as it is. Returns the length. */
size_t orl_framing_unescape(char *text);

#endif
