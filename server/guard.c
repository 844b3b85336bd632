#include "guard.h"

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

const char *orl_guard_check(const char *host, const char *origin)
{
    static const char http[] = "http://";
    if (host && !orl_guard_is_local(host))
        return "the Host header is not a name of this machine";
    if (origin && (strncasecmp(origin, http, sizeof http - 1) != 0 ||
                   !orl_guard_is_local(origin + sizeof http - 1)))
        return "it comes from a web page of another site";
    return NULL;
}
