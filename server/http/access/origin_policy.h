/*
 * The rules for web pages that may use the daemon: its own pages, and those of origins that
 * --allow-origin names.
 *
 * Without tokens, programs of this machine may do everything. A page in a browser on this machine
 * can reach loopback too. It may use a form or fetch (the browser then sends Origin), or point a
 * host name of its own at 127.0.0.1 (Host is then that name). Both are refused; programs send
 * neither, or loopback's own names. A page that another program of this machine serves, on another
 * port, is another site. A proxy that forwards requests of other machines makes them look local. So
 * a request with a header that says it was forwarded is refused. Behind a proxy, tokens must be
 * required (--tokens always).
 *
 * A browser may follow another page's link to the dashboard. This must be a top-level GET of the
 * one page that is identical for all users, and Cross-Origin-Opener-Policy keeps the linking page
 * from accessing it. So nothing is read or changed.
 *
 * With tokens any Host is allowed, and a browser may follow any link. A request that another
 * origin's page sent is still refused.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_ORIGIN_POLICY_H
#define ORL_SERVER_HTTP_ACCESS_ORIGIN_POLICY_H

#include <stdbool.h>
#include <stddef.h>

/* Returns true for "localhost", 127.x.y.z or [::1], with or without a port. */
bool orl_host_is_loopback(const char *host);

/* Returns true if, by Sec-Fetch-Site, the request was sent by a page of the daemon, by the user, or
 * not by a browser (NULL). */
bool orl_fetch_site_is_own(const char *fetch_site);

/* Headers of a request (NULL when absent), and settings of the daemon. */
struct orl_origin_policy_input {
    const char *host, *origin, *fetch_site; /* Sec-Fetch-Site */
    bool forwarded;                         /* Forwarded, X-Forwarded-* or Via is present */
    bool follows_link;                      /* a link to the dashboard's page, as above */
    bool tokens;                            /* tokens are required */
    bool http, https;                       /* schemes that the daemon's own pages may use */
    const char *const *allowed;             /* allowed other origins (process/config.h) */
    size_t n_allowed;
};

/* Returns NULL, or the reason for refusing the request. *ret_allowed: true if its origin is in
 * allowed. */
const char *orl_origin_policy_check(const struct orl_origin_policy_input *request,
                                    bool *ret_allowed);

#endif
