/*
 * Which web pages may talk to the daemon: its own, and those of origins that --allow-origin names.
 *
 * Without tokens programs of this machine may do everything, and a page in a browser on this
 * machine can reach loopback too: by a form or fetch (the browser then sends Origin), or by
 * pointing a name of its own at 127.0.0.1 (Host is then that name). Both are refused; programs send
 * neither, or loopback's own names. A page that another program on this machine serves, on another
 * port, is another site. A proxy that carries strangers' requests here makes them look like this
 * machine's: what says that it was forwarded is refused, and behind a proxy tokens are to be asked
 * for
 * (--tokens always).
 *
 * A browser may follow another page's link to the dashboard: as long as that is a GET of the one
 * page that is the same for everybody, into a window of its own, which the page that had the link
 * cannot look into (Cross-Origin-Opener-Policy), nothing is read or done by it.
 *
 * With tokens any Host will do, and a browser may follow a link to here; but what says that another
 * origin's page has sent it is refused all the same.
 */
#ifndef ORL_SERVER_HTTP_GUARD_H
#define ORL_SERVER_HTTP_GUARD_H

#include <stdbool.h>
#include <stddef.h>

/* Is it "localhost", 127.x.y.z or [::1], with or without a port? */
bool orl_guard_is_local(const char *host);

/* Has a page of the daemon itself sent it, by its Sec-Fetch-Site; or the user, or no browser
 * (NULL)? */
bool orl_guard_is_ours(const char *fetch_site);

/* Headers of a request, NULL when absent, and what the daemon is. */
struct orl_guarded {
    const char *host, *origin, *fetch_site; /* Sec-Fetch-Site */
    bool forwarded;                         /* Forwarded, X-Forwarded-* or Via is there */
    bool follows_link;                      /* to the dashboard's page, as above */
    bool tokens;                            /* are needed */
    bool http, https;                       /* what its own pages may have come by */
    const char *const *allowed;             /* origins of others: process/origin.h */
    size_t n_allowed;
};

/* Returns NULL, or why the request is refused. *ret_allowed: it comes from one of allowed. */
const char *orl_guard_check(const struct orl_guarded *request, bool *ret_allowed);

#endif
