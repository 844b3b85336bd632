/*
 * Serving of requests: headers, route, token, body, handler, and the answer up to its last byte.
 * These are libmicrohttpd's callbacks; the closure is the struct orl_http_context.
 *
 * Threads: loop.
 */
#ifndef ORL_SERVER_HTTP_SERVE_H
#define ORL_SERVER_HTTP_SERVE_H

#include "http/request/request.h"

void *orl_serve_begin(void *context, const char *uri, struct MHD_Connection *connection);
/* Unescapes a part of the target. Cuts a connection off if its target has a NUL followed by a
 * query. */
size_t orl_serve_unescape(void *context, struct MHD_Connection *connection, char *text);
enum MHD_Result orl_serve_handle(void *context, struct MHD_Connection *connection, const char *url,
                                 const char *method, const char *version, const char *data,
                                 size_t *data_size, void **request);
void orl_serve_completed(void *context, struct MHD_Connection *connection, void **request,
                         enum MHD_RequestTerminationCode why);

#endif
