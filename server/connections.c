#include "connections.h"

#include <stdlib.h>
#include <sys/socket.h>

#include "limits.h"
#include "times.h"

enum awaited { AWAITS_HEADERS, AWAITS_BODY, AWAITS_NOTHING };

struct orl_connection {
    int fd;
    enum awaited awaited;
    double until_s; /* headers: when they must be there; body: when its rate begins to count */
    double since_s; /* body */
    uint64_t received;
    double idle_s;
    struct orl_connection *next, *before;
};

static struct orl_connection *of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info ? info->socket_context : NULL;
}

static void open_connection(struct orl_connections *all, struct MHD_Connection *connection,
                            void **context)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    struct orl_connection *one = info ? calloc(1, sizeof *one) : NULL;
    if (!one)
        return; /* it goes unwatched but for silence */
    one->fd = info->connect_fd;
    one->idle_s = all->idle_s;
    one->until_s = orl_time_steady_s() +
                   (all->idle_s < ORL_SERVER_HEADER_S ? all->idle_s : ORL_SERVER_HEADER_S);
    one->next = all->first;
    if (all->first)
        all->first->before = one;
    all->first = one;
    *context = one;
}

void orl_connections_notify(void *connections, struct MHD_Connection *connection, void **context,
                            enum MHD_ConnectionNotificationCode code)
{
    struct orl_connections *all = connections;
    struct orl_connection *one = *context;
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
        all->open++;
        open_connection(all, connection, context);
        return;
    }
    all->open--;
    if (!one)
        return;
    if (one->before)
        one->before->next = one->next;
    else
        all->first = one->next;
    if (one->next)
        one->next->before = one->before;
    free(one);
    *context = NULL;
}

void orl_connection_headers(struct MHD_Connection *connection)
{
    struct orl_connection *one = of(connection);
    if (!one)
        return;
    one->awaited = AWAITS_BODY;
    one->received = 0;
    one->since_s = orl_time_steady_s();
    one->until_s = one->since_s + one->idle_s;
}

void orl_connection_received(struct MHD_Connection *connection, size_t bytes)
{
    struct orl_connection *one = of(connection);
    if (one)
        one->received += bytes;
}

void orl_connection_body(struct MHD_Connection *connection)
{
    struct orl_connection *one = of(connection);
    if (one)
        one->awaited = AWAITS_NOTHING;
}

void orl_connection_over(struct MHD_Connection *connection)
{
    struct orl_connection *one = of(connection);
    if (!one)
        return;
    one->awaited = AWAITS_HEADERS;
    one->until_s = orl_time_steady_s() + one->idle_s;
}

/*
 * Has the client stopped sending? libmicrohttpd does not hear of it when the end comes together
 * with the last bytes before it (it waits for another edge of epoll), and would keep the connection
 * until it is slow. A second end, for our side of reading alone, is such an edge; an answer that is
 * under way still goes out.
 */
static void note_end(const struct orl_connection *one)
{
    char next;
    if (recv(one->fd, &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0)
        shutdown(one->fd, SHUT_RD);
}

void orl_connections_sweep(struct orl_connections *all)
{
    const double now_s = orl_time_steady_s();
    for (struct orl_connection *one = all->first; one; one = one->next) {
        if (one->awaited == AWAITS_NOTHING)
            continue;
        note_end(one);
        if (now_s < one->until_s)
            continue;
        if (one->awaited == AWAITS_BODY &&
            (double)one->received >= ORL_SERVER_BODY_RATE * (now_s - one->since_s))
            continue;
        /* The descriptor stays libmicrohttpd's, which finds the connection ended and closes it. */
        shutdown(one->fd, SHUT_RDWR);
        one->awaited = AWAITS_NOTHING;
        all->cut++;
    }
}
