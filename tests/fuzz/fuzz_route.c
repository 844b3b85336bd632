/*
 * A request's target. The input is "METHOD TARGET", as a request line without its version. The
 * target as libmicrohttpd decodes it selects a route, and the route's parameters are parts of the
 * target. Accepted query arguments are within their bounds.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "http/context.h"
#include "http/request/parse_request.h"
#include "process/limits.h"
#include "store/files/scene_bundle.h"
#include "support/wire.h"

/* Routes of every shape that the daemon has. */
static const struct orl_route table[] = {
    {"GET", "/", ORL_SCOPE_OPEN, NULL, 0, NULL, false},
    {"GET", "/v1/jobs", ORL_SCOPE_READ, NULL, 0, NULL, false},
    {"POST", "/v1/jobs", ORL_SCOPE_SUBMIT, NULL, 1, NULL, false},
    {"GET", "/v1/jobs/{}", ORL_SCOPE_READ, NULL, 0, NULL, false},
    {"DELETE", "/v1/jobs/{}", ORL_SCOPE_SUBMIT, NULL, 0, NULL, false},
    {"POST", "/v1/jobs/{}/cancel", ORL_SCOPE_SUBMIT, NULL, 1, NULL, false},
    {"GET", "/v1/jobs/{}/files/{*}", ORL_SCOPE_READ, NULL, 0, NULL, false},
    {"DELETE", "/v1/maps/{}/{}", ORL_SCOPE_ADMIN, NULL, 0, NULL, false},
};
static const struct orl_routes routes = {table, sizeof table / sizeof *table};

/* Checks that the pattern with its parameters filled in equals the target. */
static void check_params(const char *path, const char *url,
                         char params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX])
{
    char *built = NULL;
    size_t size = 0, param = 0;
    FILE *text = open_memstream(&built, &size);
    FUZZ_PROMISE(text != NULL);
    for (const char *at = path; *at; at++) {
        if (*at != '{') {
            fputc(*at, text);
            continue;
        }
        const bool rest = at[1] == '*';
        FUZZ_PROMISE(params[param][0] && (rest || !strchr(params[param], '/')));
        fputs(params[param++], text);
        at += rest ? 2 : 1;
    }
    fclose(text);
    FUZZ_PROMISE(strcmp(built, url) == 0);
    free(built);
}

/* Returns true if the name cannot leave its folder. */
static bool stays_inside(const char *name)
{
    for (const char *part = name; part; part = strchr(part, '/') ? strchr(part, '/') + 1 : NULL) {
        const size_t length = strcspn(part, "/");
        if (length == 0 || strncmp(part, "./", 2) == 0 || strncmp(part, "../", 3) == 0 ||
            strcmp(part, ".") == 0 || strcmp(part, "..") == 0)
            return false;
    }
    return strlen(name) < 256;
}

static enum MHD_Result check_argument(void *ctx, enum MHD_ValueKind kind, const char *name,
                                      const char *value)
{
    bool *understood = ctx;
    unsigned long count = 0;
    struct orl_error err = {0};
    (void)kind;
    if (!value)
        return MHD_YES;
    if (strcmp(name, "limit") == 0) {
        const bool good = orl_query_count(value, ORL_SERVER_LIST, &count);
        char again[24];
        snprintf(again, sizeof again, "%lu", count);
        FUZZ_PROMISE(!good || (count >= 1 && count <= ORL_SERVER_LIST));
        FUZZ_PROMISE(!good || strcmp(value + strspn(value, "0"), again) == 0);
        *understood = *understood && good;
    } else if (strcmp(name, "name") == 0 || strcmp(name, "main") == 0) {
        const int code = orl_bundle_check_name(value, &err);
        if (code < 0)
            fuzz_check_error(code, &err);
        else
            FUZZ_PROMISE(stays_inside(value));
        *understood = *understood && code == 0;
    }
    return MHD_YES;
}

static void see(void *ctx, const struct wire_request *request)
{
    bool *accepted = ctx, understood = true;
    char params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX], allow[64];
    const struct orl_route *route = NULL;
    if (request->ended)
        return;
    memset(params, 'x', sizeof params);
    const unsigned status =
        orl_router_find(&routes, request->method, request->url, &route, params, allow);
    FUZZ_PROMISE(status == 0 || status == 404 || status == 405);
    FUZZ_PROMISE(memchr(allow, '\0', sizeof allow) != NULL);
    FUZZ_PROMISE(status == 0 || (status == 405) == (allow[0] != '\0'));
    FUZZ_PROMISE((status == 0) == (route != NULL));
    if (route)
        check_params(route->path, request->url, params);
    MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, check_argument,
                              &understood);
    *accepted = route && understood && !request->too_long;
}

bool fuzz_route(const uint8_t *data, size_t size)
{
    static const char end[] = " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    bool accepted = false;
    char *text = malloc(size + sizeof end);
    if (!text)
        return false;
    memcpy(text, data, size);
    memcpy(text + size, end, sizeof end);
    wire_send(text, size + sizeof end - 1, see, &accepted);
    free(text);
    return accepted;
}
