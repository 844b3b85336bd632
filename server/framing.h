/*
 * Whose a request is and where it ends, by its headers (RFC 9112, 3.2 and 6.3). What could be read
 * in two ways, by us and by a proxy in front, is refused, lest one request hide inside another
 * (11.2). Threads: loop.
 */
#ifndef ORL_SERVER_FRAMING_H
#define ORL_SERVER_FRAMING_H

#include <microhttpd.h>

/* NULL, or the sentence to refuse it with. */
const char *orl_framing_check(struct MHD_Connection *connection, const char *version);

#endif
