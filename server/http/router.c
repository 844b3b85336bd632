#include "http/context.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Returns true if url matches the pattern path. Fills the parameters. */
static bool path_matches(const char *path, const char *url,
                         char ret_params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX])
{
    size_t param = 0;
    while (*path) {
        if (path[0] != '{') {
            if (*path++ != *url++)
                return false;
            continue;
        }
        const bool rest = path[1] == '*';
        const size_t length = rest ? strlen(url) : strcspn(url, "/");
        if (length == 0 || length >= ORL_PARAM_MAX || param == ORL_ROUTE_PARAMS)
            return false;
        memcpy(ret_params[param], url, length);
        ret_params[param++][length] = '\0';
        url += length;
        path += rest ? 3 : 2;
    }
    return *url == '\0';
}

static void add_allowed_method(const char *method, char ret_allow[64])
{
    const size_t used = strlen(ret_allow);
    snprintf(ret_allow + used, 64 - used, "%s%s%s", used ? ", " : "", method,
             strcmp(method, "GET") == 0 ? ", HEAD" : "");
}

unsigned orl_router_find(const struct orl_routes *routes, const char *method, const char *url,
                         const struct orl_route **ret_route,
                         char ret_params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX], char ret_allow[64])
{
    const char *wanted = strcmp(method, "HEAD") == 0 ? "GET" : method;
    ret_allow[0] = '\0';
    for (size_t i = 0; i < routes->count; i++) {
        if (!path_matches(routes->table[i].path, url, ret_params))
            continue;
        if (strcmp(routes->table[i].method, wanted) == 0) {
            *ret_route = &routes->table[i];
            return 0;
        }
        add_allowed_method(routes->table[i].method, ret_allow);
    }
    return ret_allow[0] ? 405 : 404;
}

size_t orl_router_index(const struct orl_routes *routes, const struct orl_route *route)
{
    return route ? (size_t)(route - routes->table) : routes->count;
}

bool orl_router_accepts(const struct orl_route *route, const char *content_type)
{
    if (!route->types)
        return true;
    if (!content_type)
        return false;
    const size_t length = strcspn(content_type, "; \t");
    for (const char *const *type = route->types; *type; type++)
        if (strlen(*type) == length && strncasecmp(*type, content_type, length) == 0)
            return true;
    return false;
}

const char *orl_router_types(const struct orl_route *route, char ret_types[160])
{
    int used = 0;
    ret_types[0] = '\0';
    for (size_t i = 0; route->types && route->types[i] && used < 160; i++)
        used += snprintf(ret_types + used, 160 - (size_t)used, "%s%s",
                         i == 0                ? ""
                         : route->types[i + 1] ? ", "
                                               : " or ",
                         route->types[i]);
    return ret_types;
}
