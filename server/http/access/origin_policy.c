#include "http/access/origin_policy.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

#include "process/config.h"

bool orl_host_is_loopback(const char *host)
{
    char name[64];
    struct in_addr v4;
    struct in6_addr v6;
    const size_t length = host[0] == '[' ? strcspn(host, "]") + 1 : strcspn(host, ":");
    if (length >= sizeof name || length > strlen(host))
        return false;
    const char *port = host + length;
    if (*port == ':')
        port++;
    if (port[strspn(port, "0123456789")] != '\0' || (port == host + length && *port))
        return false;
    memcpy(name, host, length);
    name[length] = '\0';
    if (name[0] == '[') {
        name[length - 1] = '\0';
        return inet_pton(AF_INET6, name + 1, &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
    }
    if (strcasecmp(name, "localhost") == 0)
        return true;
    return inet_pton(AF_INET, name, &v4) == 1 && ntohl(v4.s_addr) >> 24 == 127;
}

/* Relies on the browser: true for a request of one of the daemon's own pages, or one that the user
 * typed. */
bool orl_fetch_site_is_own(const char *fetch_site)
{
    return !fetch_site || strcasecmp(fetch_site, "same-origin") == 0 ||
           strcasecmp(fetch_site, "none") == 0;
}

/* Returns true if Origin is the scheme and Host of the request itself. */
static bool is_own(const struct orl_origin_policy_input *request)
{
    static const char http[] = "http://", https[] = "https://";
    const char *origin = request->origin;
    const bool plain = request->http && strncasecmp(origin, http, sizeof http - 1) == 0;
    const bool secure = request->https && strncasecmp(origin, https, sizeof https - 1) == 0;
    if (!request->host || !*request->host || (!plain && !secure))
        return false;
    return strcasecmp(origin + (secure ? sizeof https - 1 : sizeof http - 1), request->host) == 0;
}

const char *orl_origin_policy_check(const struct orl_origin_policy_input *request,
                                    bool *ret_allowed)
{
    static const char other_site[] = "it comes from a web page of another site";
    *ret_allowed = false;
    if (!request->tokens && request->host && !orl_host_is_loopback(request->host))
        return "its Host is not a name of this machine";
    if (!request->tokens && request->forwarded)
        return "it was forwarded by a proxy, and this requires orield --tokens always";
    if (request->origin && !is_own(request)) {
        *ret_allowed = orl_origin_is_listed(request->origin, request->allowed, request->n_allowed);
        return *ret_allowed ? NULL : other_site;
    }
    /* A request for an image or script has no Origin, so the page that sent it is unknown. */
    if (!request->tokens && !request->follows_link && !orl_fetch_site_is_own(request->fetch_site))
        return other_site;
    return NULL;
}
