#include "process/config.h"

#include <arpa/inet.h>
#include <stdlib.h>
#include <string.h>

static bool is_name(const char *host, size_t length)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyz0123456789-._";
    return length > 0 && length <= 253 && strspn(host, allowed) >= length && host[0] != '.' &&
           host[0] != '-';
}

/* Returns true for an address such as "[::1]" in the form of inet_ntop, which browsers use. */
static bool is_v6(const char *host, size_t length)
{
    char inner[INET6_ADDRSTRLEN], plain[INET6_ADDRSTRLEN];
    struct in6_addr v6;
    if (length < 4 || length - 2 >= sizeof inner || host[length - 1] != ']')
        return false;
    memcpy(inner, host + 1, length - 2);
    inner[length - 2] = '\0';
    return inet_pton(AF_INET6, inner, &v6) == 1 && inet_ntop(AF_INET6, &v6, plain, sizeof plain) &&
           strcmp(inner, plain) == 0;
}

/* Returns true if the text after the host is empty, or a port other than the scheme's default. */
static bool is_port(const char *text, unsigned long own)
{
    if (*text == '\0')
        return true;
    const char *digits = text + 1;
    const size_t count = strlen(digits);
    if (*text != ':' || count == 0 || count > 5 || digits[0] == '0' ||
        strspn(digits, "0123456789") != count)
        return false;
    const unsigned long port = strtoul(digits, NULL, 10);
    return port <= 65535 && port != own;
}

int orl_origin_check(const char *text, struct orl_error *err)
{
    static const char http[] = "http://", https[] = "https://";
    const bool secure = strncmp(text, https, sizeof https - 1) == 0;
    const bool plain = strncmp(text, http, sizeof http - 1) == 0;
    const char *host = text + (secure ? sizeof https - 1 : plain ? sizeof http - 1 : 0);
    const size_t length = host[0] == '[' ? strcspn(host, "]") + 1 : strcspn(host, ":/?#@");
    const bool good = (secure || plain) && strlen(text) < ORL_ORIGIN_MAX &&
                      length <= strlen(host) &&
                      (host[0] == '[' ? is_v6(host, length) : is_name(host, length)) &&
                      is_port(host + length, secure ? 443 : 80);
    if (good)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "'%.200s' is not the origin of a web page", text);
    orl_error_hint(err, "Write it as browsers do: https://tool.example or http://localhost:3000, "
                        "in lower case, without a path or a default port (443, 80). Repeat "
                        "--allow-origin for each one; there is no wildcard");
    return ORL_ERR_INVALID;
}

bool orl_origin_is_listed(const char *origin, const char *const *list, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(origin, list[i]) == 0)
            return true;
    return false;
}
