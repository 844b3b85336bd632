#include "http/http_server.h"

#include <errno.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "http/connection/connections.h"
#include "http/context.h"
#include "process/limits.h"

enum { SWEEP_MS = 1000 };

struct orl_http_server {
    struct orl_http_context *context;
    struct MHD_Daemon *daemon;
    uv_poll_t poll;
    uv_timer_t timer, sweep;
    int listen_fd;
    char message[512]; /* libmicrohttpd's last message, used when it does not start */
    struct orl_tls tls;
    struct orl_connections connections;
    bool running; /* true inside MHD_run */
    bool closed;
};

static void on_timer(uv_timer_t *timer)
{
    orl_http_kick(timer->data);
}

static void free_certificates(struct orl_http_server *http)
{
    orl_tls_free_older(&http->tls, orl_connections_oldest_handshake(&http->connections));
}

static void on_sweep(uv_timer_t *timer)
{
    struct orl_http_server *http = timer->data;
    orl_connections_sweep(&http->connections);
    free_certificates(http);
    http->context->calls->on_tick(http->context->server);
}

static void on_readable(uv_poll_t *poll, int status, int events)
{
    (void)status, (void)events;
    orl_http_kick(poll->data);
}

void orl_http_kick(struct orl_http_server *http)
{
    enum { TURN_NS = 5000000 }; /* afterwards the loop handles other events */
    const uint64_t until = uv_hrtime() + TURN_NS;
    MHD_UNSIGNED_LONG_LONG timeout_ms = 0;
    bool more = true, timed = true;
    if (!http || http->running || http->closed)
        return;
    http->running = true;
    while (more && uv_hrtime() < until) {
        MHD_run(http->daemon);
        timed = MHD_get_timeout(http->daemon, &timeout_ms) == MHD_YES;
        more = timed && timeout_ms == 0;
    }
    http->running = false;
    if (more)
        orl_connections_cut_stuck(&http->connections);
    /* Never 0: libuv runs due timers until none is left, and this one would be due again from
     * within its own callback. Nothing else on the loop would run. */
    if (timed)
        uv_timer_start(&http->timer, on_timer, timeout_ms > 0 ? timeout_ms : 1, 0);
    else
        uv_timer_stop(&http->timer);
    http->context->calls->on_served(http->context->server);
}

static void on_message(void *ctx, const char *format, va_list args)
    __attribute__((format(printf, 2, 0)));
static void on_message(void *ctx, const char *format, va_list args)
{
    struct orl_http_server *http = ctx;
    vsnprintf(http->message, sizeof http->message, format, args);
    http->message[strcspn(http->message, "\r\n")] = '\0';
    orl_log_event(http->context->log, ORL_LOG_DEBUG, "http", "s", "message", http->message);
    orl_connections_refuse_unparsed(&http->connections);
}

static int listen_on(const struct sockaddr *address, int *ret_fd, struct orl_error *err)
{
    const socklen_t size =
        address->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
    const int one = 1;
    char text[80];
    const int fd = socket(address->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
        bind(fd, address, size) == 0 && listen(fd, SOMAXCONN) == 0) {
        *ret_fd = fd;
        return 0;
    }
    orl_address_format(address, text, sizeof text);
    orl_error_set(err, ORL_ERR_IO, "cannot listen on %s: %s", text, strerror(errno));
    if (errno == EADDRINUSE)
        orl_error_hint(err, "Another program listens there; use --port 0 for a free port");
    if (fd >= 0)
        close(fd);
    return ORL_ERR_IO;
}

/* Returns the limit on connections. Half of the process's descriptors are for files. */
static unsigned connection_limit(void)
{
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur / 2 >= ORL_SERVER_CONNECTIONS)
        return ORL_SERVER_CONNECTIONS;
    return files.rlim_cur > 2 ? (unsigned)(files.rlim_cur / 2) : 1;
}

static int start_daemon(struct orl_http_server *http, struct orl_error *err)
{
    const struct orl_config *config = http->context->config;
    const unsigned flags = MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG |
                           (http->tls.current ? MHD_USE_TLS : 0U);
    const struct MHD_OptionItem tls[] = {
        {MHD_OPTION_HTTPS_CERT_CALLBACK, 0, (void *)orl_tls_callback()},
        {MHD_OPTION_HTTPS_PRIORITIES, 0, (void *)(uintptr_t)ORL_TLS_PRIORITIES},
        {MHD_OPTION_END, 0, NULL}};
#if MHD_VERSION >= 0x01000000
    const struct MHD_OptionItem strict = {MHD_OPTION_CLIENT_DISCIPLINE_LVL, 1, NULL};
#else
    /* parse_request.c is strict instead. */
    const struct MHD_OptionItem strict = {MHD_OPTION_STRICT_FOR_CLIENT, 0, NULL};
#endif
    const struct MHD_OptionItem options[] = {
        strict,
        {http->tls.current ? MHD_OPTION_ARRAY : MHD_OPTION_END, 0, (void *)(uintptr_t)tls},
        {MHD_OPTION_END, 0, NULL}};
    http->daemon = MHD_start_daemon(
        flags, 0, orl_connections_allow, &http->connections, orl_serve_handle, http->context,
        MHD_OPTION_EXTERNAL_LOGGER, on_message, (void *)http, MHD_OPTION_LISTEN_SOCKET,
        http->listen_fd, MHD_OPTION_CONNECTION_LIMIT, connection_limit(),
        MHD_OPTION_CONNECTION_TIMEOUT, config->idle_timeout_s, MHD_OPTION_URI_LOG_CALLBACK,
        orl_serve_begin, (void *)http->context, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
        (size_t)ORL_SERVER_CONNECTION_MEMORY, MHD_OPTION_NOTIFY_CONNECTION, orl_connections_notify,
        (void *)&http->connections, MHD_OPTION_NOTIFY_COMPLETED, orl_serve_completed,
        (void *)http->context, MHD_OPTION_UNESCAPE_CALLBACK, orl_serve_unescape,
        (void *)http->context, MHD_OPTION_ARRAY, options, MHD_OPTION_END);
    if (!http->daemon)
        return orl_error_set(err, ORL_ERR_IO, "cannot start the HTTP server: %.300s",
                             http->message[0] ? http->message : strerror(errno));
    return 0;
}

int orl_http_start(struct orl_http_context *context, const struct sockaddr *address,
                   struct orl_http_server **ret_http, struct orl_error *err)
{
    struct orl_http_server *http = calloc(1, sizeof *http);
    if (!http)
        return orl_error_no_memory(err);
    http->context = context;
    http->connections.idle_s = context->config->idle_timeout_s;
    http->connections.most = context->config->address_connections;
    int rc = 0;
    if (context->config->tls_cert)
        rc = orl_tls_load(&http->tls, context->config->tls_cert, context->config->tls_key, 0, err);
    if (rc == 0)
        rc = listen_on(address, &http->listen_fd, err);
    if (rc)
        goto failed;
    rc = start_daemon(http, err);
    if (rc) {
        close(http->listen_fd);
        goto failed;
    }
    const union MHD_DaemonInfo *info = MHD_get_daemon_info(http->daemon, MHD_DAEMON_INFO_EPOLL_FD);
    if (!info || uv_poll_init(context->loop, &http->poll, info->epoll_fd) != 0) {
        rc = orl_error_set(err, ORL_ERR_INTERNAL, "the HTTP server has no epoll descriptor");
        MHD_stop_daemon(http->daemon);
        goto failed;
    }
    uv_timer_init(context->loop, &http->timer);
    http->poll.data = http;
    http->timer.data = http;
    uv_poll_start(&http->poll, UV_READABLE, on_readable);
    uv_timer_start(&http->timer, on_timer, 0, 0);
    uv_timer_init(context->loop, &http->sweep);
    http->sweep.data = http;
    uv_timer_start(&http->sweep, on_sweep, SWEEP_MS, SWEEP_MS);
    *ret_http = http;
    return 0;
failed:
    orl_tls_done(&http->tls);
    free(http);
    return rc;
}

const struct orl_connections *orl_http_connections(const struct orl_http_server *http)
{
    return &http->connections;
}

void orl_http_address(const struct orl_http_server *http, struct sockaddr_storage *ret_address)
{
    socklen_t size = sizeof *ret_address;
    memset(ret_address, 0, sizeof *ret_address);
    getsockname(http->listen_fd, (struct sockaddr *)ret_address, &size);
}

int orl_http_reload(struct orl_http_server *http, struct orl_error *err)
{
    const struct orl_config *config = http->context->config;
    if (!config->tls_cert)
        return 0;
    const int rc =
        orl_tls_load(&http->tls, config->tls_cert, config->tls_key, http->connections.started, err);
    free_certificates(http);
    return rc;
}

void orl_http_quiesce(struct orl_http_server *http)
{
    /* The daemon now has to close the listening socket itself. */
    const MHD_socket fd = MHD_quiesce_daemon(http->daemon);
    if (fd != MHD_INVALID_SOCKET)
        close(fd);
}

void orl_http_stop(struct orl_http_server *http)
{
    if (!http || http->closed)
        return;
    http->closed = true;
    uv_poll_stop(&http->poll);
    uv_close((uv_handle_t *)&http->poll, NULL);
    uv_close((uv_handle_t *)&http->timer, NULL);
    uv_close((uv_handle_t *)&http->sweep, NULL);
    MHD_stop_daemon(http->daemon);
}

void orl_http_free(struct orl_http_server *http)
{
    if (http)
        orl_tls_done(&http->tls);
    free(http);
}
