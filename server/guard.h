/*
 * Who may talk to a daemon without tokens: programs on this machine, not web pages.
 *
 * A page in a browser on this machine can reach loopback too: by a form or fetch (the browser then
 * sends Origin), or by pointing a name of its own at 127.0.0.1 (Host is then that name). Both are
 * refused; programs send neither, or loopback's own names.
 */
#ifndef ORL_SERVER_GUARD_H
#define ORL_SERVER_GUARD_H

#include <stdbool.h>

/* Is it "localhost", 127.x.y.z or [::1], with or without a port? */
bool orl_guard_is_local(const char *host);

/* host and origin: the headers, NULL when absent. Returns NULL, or why the request is refused. */
const char *orl_guard_check(const char *host, const char *origin);

#endif
