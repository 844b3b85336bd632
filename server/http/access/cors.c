#include "http/access/cors.h"

#include <string.h>
#include <strings.h>

#include "http/context.h"
#include "http/response/reply.h"

bool orl_cors_preflight(struct orl_request *request, const char *allow)
{
    if (!request->cross_origin || strcmp(request->method, MHD_HTTP_METHOD_OPTIONS) != 0 ||
        !orl_request_header(request, "Access-Control-Request-Method"))
        return false;
    const char *private = orl_request_header(request, "Access-Control-Request-Private-Network");
    orl_reply_no_content(request);
    orl_reply_header(request, "Access-Control-Allow-Methods", allow);
    orl_reply_header(request, "Access-Control-Allow-Headers",
                     "Authorization, Content-Type, Idempotency-Key, If-None-Match, If-Range, "
                     "Last-Event-ID, Range, X-Oriel-Client");
    orl_reply_header(request, "Access-Control-Max-Age", "600");
    /* A page from a public network may call a daemon on loopback (Private Network Access). */
    if (private && strcasecmp(private, "true") == 0)
        orl_reply_header(request, "Access-Control-Allow-Private-Network", "true");
    return true;
}

void orl_cors_add(struct orl_request *request)
{
    if (request->context->config->n_origins == 0)
        return;
    orl_reply_header(request, "Vary", "Origin");
    if (!request->cross_origin)
        return;
    orl_reply_header(request, "Access-Control-Allow-Origin",
                     orl_request_header(request, MHD_HTTP_HEADER_ORIGIN));
    orl_reply_header(request, "Access-Control-Expose-Headers",
                     "Accept-Ranges, Content-Range, ETag, Link, Location, Retry-After, "
                     "WWW-Authenticate, X-Request-Id");
}
