/*
 * The router: finds a request's route in a table of methods, paths and handlers (routes.h has the
 * daemon's table).
 */
#ifndef ORL_SERVER_HTTP_ROUTER_H
#define ORL_SERVER_HTTP_ROUTER_H

#include <stddef.h>

#include "http/request/request.h"
#include "store/rows/stored_tokens.h"

struct orl_route {
    const char *method;         /* GET also serves HEAD */
    const char *path;           /* "/v1/jobs/{}/files/{*}": each {} is a parameter without slashes,
                                   {*} the rest */
    enum orl_token_scope scope; /* scope that a token needs, if tokens are required */
    orl_request_step handler;
    uint64_t max_body;        /* 0: no body is read */
    const char *const *types; /* accepted media types of the body, ended by NULL; NULL: any */
    bool by_link;             /* true if a signed link may replace a token (signed_links.h) */
};

struct orl_routes {
    const struct orl_route *table;
    size_t count;
};

/*
 * Finds the route. Returns 0 and fills ret_route and ret_params, or an HTTP status: 404, or 405
 * with the allowed methods in ret_allow.
 */
unsigned orl_router_find(const struct orl_routes *routes, const char *method, const char *url,
                         const struct orl_route **ret_route,
                         char ret_params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX], char ret_allow[64]);

/* Returns the route's place in the table; one past the last for NULL. */
size_t orl_router_index(const struct orl_routes *routes, const struct orl_route *route);

/* Writes the accepted media types as "a, b or c". Returns ret_types. */
const char *orl_router_types(const struct orl_route *route, char ret_types[160]);

/* Returns true if the route accepts the media type of a Content-Type header (NULL: none). */
bool orl_router_accepts(const struct orl_route *route, const char *content_type);

#endif
