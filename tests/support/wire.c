#include "support/wire.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "http/request/parse_request.h"

struct own;

struct wire {
    wire_see see;
    void *ctx;
    struct own *open; /* a request whose end libmicrohttpd has not yet reported */
};

/* State of a request. */
struct own {
    bool begun, too_long;
};

/* Called as in the daemon, before the arguments are split. */
static void *on_target(void *ctx, const char *uri, struct MHD_Connection *connection)
{
    struct wire *wire = ctx;
    struct own *own = calloc(1, sizeof *own);
    (void)connection;
    if (!own)
        abort();
    own->too_long = uri && orl_framing_cut_query(uri);
    wire->open = own;
    return own;
}

static size_t on_part(void *ctx, struct MHD_Connection *connection, char *text)
{
    (void)ctx, (void)connection;
    return orl_framing_unescape(text);
}

static void on_completed(void *ctx, struct MHD_Connection *connection, void **request,
                         enum MHD_RequestTerminationCode why)
{
    struct wire *wire = ctx;
    (void)connection, (void)why;
    free(*request);
    *request = wire->open = NULL;
}

static enum MHD_Result on_request(void *ctx, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *data,
                                  size_t *size, void **request)
{
    const struct wire *wire = ctx;
    struct own *own = *request;
    struct wire_request seen = {connection, method, url, version, own->too_long, own->begun};
    (void)data;
    if (own->begun && *size > 0) {
        *size = 0;
        return MHD_YES;
    }
    wire->see(wire->ctx, &seen);
    if (!own->begun) {
        own->begun = true;
        return MHD_YES;
    }
    struct MHD_Response *response =
        MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT);
    const enum MHD_Result queued = MHD_queue_response(connection, MHD_HTTP_OK, response);
    MHD_destroy_response(response);
    return queued;
}

static void say_nothing(void *ctx, const char *format, va_list args)
    __attribute__((format(printf, 2, 0)));
static void say_nothing(void *ctx, const char *format, va_list args)
{
    (void)ctx, (void)format, (void)args;
}

/* Runs until libmicrohttpd has no more work on the bytes. */
static size_t run_daemon(struct MHD_Daemon *daemon, int fd)
{
    enum { TURNS = 64 };
    char answer[4096];
    size_t total = 0;
    for (int i = 0; i < TURNS; i++) {
        MHD_run(daemon);
        const ssize_t n = recv(fd, answer, sizeof answer, MSG_DONTWAIT);
        if (n == 0)
            break;
        total += n > 0 ? (size_t)n : 0;
    }
    return total;
}

size_t wire_send(const void *bytes, size_t size, wire_see see, void *ctx)
{
    struct wire wire = {see, ctx, NULL};
    const struct sockaddr_storage nobody = {.ss_family = AF_UNIX};
    const int room = 1 << 20;
    int fds[2];
    struct MHD_Daemon *daemon = MHD_start_daemon(
        MHD_USE_NO_LISTEN_SOCKET | MHD_USE_ERROR_LOG, 0, NULL, NULL, on_request, &wire,
        MHD_OPTION_EXTERNAL_LOGGER, say_nothing, NULL, MHD_OPTION_URI_LOG_CALLBACK, on_target,
        &wire, MHD_OPTION_NOTIFY_COMPLETED, on_completed, &wire, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
        (size_t)(32 << 10), MHD_OPTION_UNESCAPE_CALLBACK, on_part, NULL,
        MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END);
    if (!daemon || socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) != 0)
        abort();
    setsockopt(fds[0], SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    if (send(fds[0], bytes, size, MSG_NOSIGNAL) != (ssize_t)size)
        abort(); /* larger than a pipe's buffer: inputs are small */
    shutdown(fds[0], SHUT_WR);
    size_t total = 0;
    if (MHD_add_connection(daemon, fds[1], (const struct sockaddr *)&nobody, sizeof nobody) ==
        MHD_YES)
        total = run_daemon(daemon, fds[0]);
    MHD_stop_daemon(daemon);
    free(wire.open);
    close(fds[0]);
    return total;
}
