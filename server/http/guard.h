/*
 * Who may talk to a daemon without tokens: programs on this machine, not web pages.
 *
 * A page in a browser on this machine can reach loopback too: by a form or fetch (the browser then
 * sends Origin), or by pointing a name of its own at 127.0.0.1 (Host is then that name). Both are
 * refused; programs send neither, or loopback's own names. A page that another program on this
 * machine serves, on another port, is another site. A proxy that carries strangers' requests here
 * makes them look like this machine's: what says that it was forwarded is refused, and behind a
 * proxy tokens are to be asked for (--tokens always).
 */
#ifndef ORL_SERVER_HTTP_GUARD_H
#define ORL_SERVER_HTTP_GUARD_H

#include <stdbool.h>

/* Is it "localhost", 127.x.y.z or [::1], with or without a port? */
bool orl_guard_is_local(const char *host);

/* Headers of a request, NULL when absent. */
struct orl_guarded {
    const char *host, *origin, *fetch_site; /* Sec-Fetch-Site */
    bool forwarded;                         /* Forwarded, X-Forwarded-* or Via is there */
};

/* Returns NULL, or why the request is refused. */
const char *orl_guard_check(const struct orl_guarded *request);

#endif
