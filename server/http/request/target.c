#include "http/request/target.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

const char *orl_target_split(const char *url, struct orl_target *ret_target, const char **ret_path)
{
    static const char http[] = "http://", https[] = "https://";
    struct orl_target target = {.https = strncasecmp(url, https, sizeof https - 1) == 0};
    const bool absolute = target.https || strncasecmp(url, http, sizeof http - 1) == 0;
    const char *authority = url + (target.https ? sizeof https : sizeof http) - 1;
    *ret_path = url;
    if (absolute) {
        const size_t length = strcspn(authority, "/");
        if (length == 0 || length >= sizeof target.authority)
            return "its target has no authority that can be one";
        memcpy(target.authority, authority, length);
        if (strpbrk(target.authority, "@#\\ \t"))
            return "its target has more than host and port before the path";
        *ret_path = authority[length] ? authority + length : "/";
    }
    *ret_target = target;
    return NULL;
}
