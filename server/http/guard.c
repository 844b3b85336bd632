#include "http/guard.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

bool orl_guard_is_local(const char *host)
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

/* The browser's own word: a request of a page of ours, or one that the user typed. */
static bool is_ours(const char *fetch_site)
{
    return strcasecmp(fetch_site, "same-origin") == 0 || strcasecmp(fetch_site, "none") == 0;
}

const char *orl_guard_check(const struct orl_guarded *request)
{
    static const char http[] = "http://", other_site[] = "it comes from a web page of another site";
    const char *host = request->host, *origin = request->origin;
    if (host && !orl_guard_is_local(host))
        return "the Host header is not a name of this machine";
    if (request->forwarded)
        return "it was forwarded by a proxy, behind which orield takes --tokens always";
    if (origin && (strncasecmp(origin, http, sizeof http - 1) != 0 || !host ||
                   strcasecmp(origin + sizeof http - 1, host) != 0))
        return other_site;
    if (request->fetch_site && !is_ours(request->fetch_site))
        return other_site;
    return NULL;
}
