/*
 * The HTTP server: libmicrohttpd on the libuv loop (http_server.c), and the serving of requests
 * (serve.c).
 */
#ifndef ORL_SERVER_HTTP_HTTP_SERVER_H
#define ORL_SERVER_HTTP_HTTP_SERVER_H

#include <uv.h>

#include <oriel/base/error.h>
#include <sys/socket.h>

#include "http/request/request.h"

/*
 * libmicrohttpd on the libuv loop.
 *
 * MHD runs without a thread of its own, on an epoll descriptor that the loop polls. MHD's sockets
 * in it are edge-triggered, so MHD is run until it has nothing more to do; a timer honours the
 * duration that MHD_get_timeout returns. After a connection is resumed the loop must kick it.
 * A client that disconnects in the middle of its body may go unnoticed until the idle timeout. When
 * the last bytes and the end arrive together, MHD 0.9.75 takes the edge for the bytes alone.
 *
 * Threads: the loop thread only.
 */

struct orl_connections;
struct orl_http_server;
struct orl_http_context;

/* Listens on address (port 0: a free one). Borrows context, for the callbacks below. Uses TLS
 * if the settings name a certificate. */
int orl_http_start(struct orl_http_context *context, const struct sockaddr *address,
                   struct orl_http_server **ret_http, struct orl_error *err);
/* Returns the open connections and the count of those cut off for slowness. */
const struct orl_connections *orl_http_connections(const struct orl_http_server *http);
/* Writes the listening address. */
void orl_http_address(const struct orl_http_server *http, struct sockaddr_storage *ret_address);
/* Runs MHD. Do not call it from within a handler. NULL (not started) is allowed. */
void orl_http_kick(struct orl_http_server *http);
/* Reads certificate and key again, for new connections; an invalid one changes nothing. */
int orl_http_reload(struct orl_http_server *http, struct orl_error *err);
/* Stops accepting connections. */
void orl_http_quiesce(struct orl_http_server *http);
/* Closes all connections; none may be suspended. The handles close in the loop's next turns. */
void orl_http_stop(struct orl_http_server *http); /* NULL is allowed */
/* Frees the server once the loop has ended. */
void orl_http_free(struct orl_http_server *http);

/*
 * Serving of requests: headers, route, token, body, handler, and the answer up to its last byte.
 * These are libmicrohttpd's callbacks; the closure is the struct orl_http_context.
 *
 * Threads: the loop thread only.
 */

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
