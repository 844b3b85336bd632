#include "router.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "handlers.h"
#include "limits.h"
#include "metrics.h"

static const char *const json_types[] = {"application/json", NULL};
static const char *const scene_types[] = {"multipart/form-data", "application/json",
                                          "application/zip", "application/x-zip-compressed", NULL};

static const struct orl_route routes[] = {
    {"GET", "/", ORL_SCOPE_OPEN, orl_handle_index, 0, NULL},
    {"GET", "/healthz", ORL_SCOPE_OPEN, orl_handle_health, 0, NULL},
    {"GET", "/readyz", ORL_SCOPE_OPEN, orl_handle_ready, 0, NULL},
    {"GET", "/metrics", ORL_SCOPE_READ, orl_handle_metrics, 0, NULL},
    {"GET", "/openapi.yaml", ORL_SCOPE_OPEN, orl_handle_openapi, 0, NULL},
    {"GET", "/v1/limits", ORL_SCOPE_READ, orl_handle_limits, 0, NULL},
    {"POST", "/v1/scenes", ORL_SCOPE_SUBMIT, orl_handle_scene_post, ORL_SERVER_SCENE_BYTES,
     scene_types},
    {"GET", "/v1/scenes/{}", ORL_SCOPE_READ, orl_handle_scene_get, 0, NULL},
    {"DELETE", "/v1/scenes/{}", ORL_SCOPE_ADMIN, orl_handle_scene_delete, 0, NULL},
    {"POST", "/v1/bsdfs", ORL_SCOPE_SUBMIT, orl_handle_bsdf_post, ORL_LIMIT_FILE_BYTES, NULL},
    {"GET", "/v1/bsdfs/{}", ORL_SCOPE_READ, orl_handle_bsdf_get, 0, NULL},
    {"DELETE", "/v1/bsdfs/{}", ORL_SCOPE_ADMIN, orl_handle_bsdf_delete, 0, NULL},
    {"POST", "/v1/jobs", ORL_SCOPE_SUBMIT, orl_handle_job_post, ORL_LIMIT_JOB_BYTES, json_types},
    {"GET", "/v1/jobs", ORL_SCOPE_READ, orl_handle_job_list, 0, NULL},
    {"GET", "/v1/jobs/{}", ORL_SCOPE_READ, orl_handle_job_get, 0, NULL},
    {"DELETE", "/v1/jobs/{}", ORL_SCOPE_SUBMIT, orl_handle_job_delete, 0, NULL},
    {"POST", "/v1/jobs/{}/cancel", ORL_SCOPE_SUBMIT, orl_handle_job_cancel, 4096, NULL},
    {"GET", "/v1/jobs/{}/events", ORL_SCOPE_READ, orl_handle_job_events, 0, NULL},
    {"GET", "/v1/jobs/{}/result", ORL_SCOPE_READ, orl_handle_job_result, 0, NULL},
    {"GET", "/v1/jobs/{}/files/{}", ORL_SCOPE_READ, orl_handle_job_file, 0, NULL},
    {"GET", "/v1/maps", ORL_SCOPE_READ, orl_handle_map_list, 0, NULL},
    {"DELETE", "/v1/maps/{}/{}", ORL_SCOPE_ADMIN, orl_handle_map_delete, 0, NULL},
};

/* Does url have the shape of path? Fills the parameters on the way. */
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
        const size_t length = strcspn(url, "/");
        if (length == 0 || length >= ORL_PARAM_MAX || param == ORL_ROUTE_PARAMS)
            return false;
        memcpy(ret_params[param], url, length);
        ret_params[param++][length] = '\0';
        url += length;
        path += 2;
    }
    return *url == '\0';
}

static void allow(const char *method, char ret_allow[64])
{
    const size_t used = strlen(ret_allow);
    snprintf(ret_allow + used, 64 - used, "%s%s%s", used ? ", " : "", method,
             strcmp(method, "GET") == 0 ? ", HEAD" : "");
}

unsigned orl_router_find(const char *method, const char *url, const struct orl_route **ret_route,
                         char ret_params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX], char ret_allow[64])
{
    const char *wanted = strcmp(method, "HEAD") == 0 ? "GET" : method;
    ret_allow[0] = '\0';
    for (size_t i = 0; i < sizeof routes / sizeof *routes; i++) {
        if (!path_matches(routes[i].path, url, ret_params))
            continue;
        if (strcmp(routes[i].method, wanted) == 0) {
            *ret_route = &routes[i];
            return 0;
        }
        allow(routes[i].method, ret_allow);
    }
    return ret_allow[0] ? 405 : 404;
}

_Static_assert(sizeof routes / sizeof *routes < ORL_METRICS_ROUTES, "a histogram for each route");

const struct orl_route *orl_router_at(size_t index)
{
    return index < sizeof routes / sizeof *routes ? &routes[index] : NULL;
}

size_t orl_router_index(const struct orl_route *route)
{
    return route ? (size_t)(route - routes) : sizeof routes / sizeof *routes;
}

size_t orl_router_count(void)
{
    return sizeof routes / sizeof *routes;
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
