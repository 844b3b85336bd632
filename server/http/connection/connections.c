#include "http/connection/connections.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <arpa/inet.h>
#include <gnutls/gnutls.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "process/limits.h"
#include "process/times.h"

void orl_address_key(const struct sockaddr *address, char ret_key[ORL_ADDRESS_KEY])
{
    char text[INET6_ADDRSTRLEN] = "unknown";
    struct sockaddr_in6 v6;
    struct sockaddr_in v4;
    const char *network = "";
    if (address && address->sa_family == AF_INET6) {
        memcpy(&v6, address, sizeof v6);
        if (IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr)) {
            inet_ntop(AF_INET, &v6.sin6_addr.s6_addr[12], text, sizeof text);
        } else {
            memset(&v6.sin6_addr.s6_addr[8], 0, 8);
            inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
            network = "/64";
        }
    } else if (address && address->sa_family == AF_INET) {
        memcpy(&v4, address, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
    }
    snprintf(ret_key, ORL_ADDRESS_KEY, "%s%s", text, network);
}

enum awaited { AWAITS_HEADERS, AWAITS_BODY, AWAITS_NOTHING };

struct orl_address {
    char key[ORL_ADDRESS_KEY];
    unsigned open;
    struct orl_address *next;
};

struct orl_connection {
    struct MHD_Connection *handle;
    int fd;
    uint64_t serial;
    bool has_requested;          /* then the TLS handshake is over */
    struct orl_address *address; /* the entry that counts it; NULL: out of memory */
    enum awaited awaited;
    double until_s; /* headers: their deadline; body: when its rate begins to count */
    double since_s; /* start of the body */
    uint64_t received;
    double held_s; /* when it was suspended to wait for the daemon; 0: it was not */
    /* Found by the last sweep: bytes of the body received, and bytes read of the connection. */
    uint64_t swept, swept_taken;
    bool stuck;    /* true if the last sweep found no progress */
    uint64_t left; /* bytes read by the last check if more were unread; 0: none */
    double idle_s;
    struct orl_connection *next, *before;
};

static struct orl_connection *connection_of(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info ? info->socket_context : NULL;
}

/* Returns the slot of the address's entry, or the slot where it would be. */
static struct orl_address **find_address(struct orl_connections *all, const char *key)
{
    unsigned hash = 0;
    for (const char *c = key; *c; c++)
        hash = 31 * hash + (unsigned char)*c;
    struct orl_address **at = &all->addresses[hash % ORL_ADDRESS_BUCKETS];
    while (*at && strcmp((*at)->key, key) != 0)
        at = &(*at)->next;
    return at;
}

enum MHD_Result orl_connections_allow(void *connections, const struct sockaddr *address,
                                      socklen_t size)
{
    struct orl_connections *all = connections;
    char key[ORL_ADDRESS_KEY];
    (void)size;
    orl_address_key(address, key);
    const struct orl_address *known = *find_address(all, key);
    return known && known->open >= all->most ? MHD_NO : MHD_YES;
}

static struct orl_address *count_address(struct orl_connections *all,
                                         struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    char key[ORL_ADDRESS_KEY];
    orl_address_key(info ? info->client_addr : NULL, key);
    struct orl_address **at = find_address(all, key);
    if (!*at) {
        *at = calloc(1, sizeof **at);
        if (!*at)
            return NULL;
        memcpy((*at)->key, key, sizeof key);
    }
    (*at)->open++;
    return *at;
}

static void uncount_address(struct orl_connections *all, struct orl_address *address)
{
    if (!address || --address->open > 0)
        return;
    *find_address(all, address->key) = address->next;
    free(address);
}

static void open_connection(struct orl_connections *all, struct MHD_Connection *connection,
                            void **context)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    struct orl_connection *one = info ? calloc(1, sizeof *one) : NULL;
    all->started++;
    if (!one) {
        all->unwatched++; /* only silence is bounded then */
        return;
    }
    one->handle = connection;
    one->fd = info->connect_fd;
    one->serial = all->started;
    one->address = count_address(all, connection);
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
    if (!one) {
        all->unwatched--;
        return;
    }
    if (one->before)
        one->before->next = one->next;
    else
        all->first = one->next;
    if (one->next)
        one->next->before = one->before;
    uncount_address(all, one->address);
    free(one);
    *context = NULL;
}

uint64_t orl_connections_oldest_handshake(const struct orl_connections *connections)
{
    uint64_t oldest = connections->started + 1;
    for (const struct orl_connection *one = connections->first; one; one = one->next)
        if (!one->has_requested && one->serial < oldest)
            oldest = one->serial;
    return connections->unwatched > 0 ? 0 : oldest;
}

void orl_connection_headers_complete(struct MHD_Connection *connection)
{
    struct orl_connection *one = connection_of(connection);
    if (!one)
        return;
    one->has_requested = true;
    one->awaited = AWAITS_BODY;
    one->received = one->swept = 0;
    one->swept_taken = UINT64_MAX;
    one->stuck = false;
    one->since_s = orl_time_steady_s();
    one->until_s = one->since_s + one->idle_s;
}

void orl_connection_received(struct MHD_Connection *connection, size_t bytes)
{
    struct orl_connection *one = connection_of(connection);
    if (one)
        one->received += bytes;
}

void orl_connection_suspend(struct MHD_Connection *connection)
{
    struct orl_connection *one = connection_of(connection);
    if (one)
        one->held_s = orl_time_steady_s();
}

void orl_connection_resume(struct MHD_Connection *connection)
{
    struct orl_connection *one = connection_of(connection);
    if (!one || one->held_s == 0)
        return;
    one->since_s += orl_time_steady_s() - one->held_s;
    one->held_s = 0;
}

void orl_connection_body_complete(struct MHD_Connection *connection)
{
    struct orl_connection *one = connection_of(connection);
    if (one)
        one->awaited = AWAITS_NOTHING;
}

void orl_connection_end_request(struct MHD_Connection *connection)
{
    struct orl_connection *one = connection_of(connection);
    if (!one)
        return;
    one->awaited = AWAITS_HEADERS;
    one->held_s = 0;
    one->until_s = orl_time_steady_s() + one->idle_s;
}

/*
 * Notices that the client has stopped sending. libmicrohttpd misses the end when it arrives
 * together with the last bytes before it, since it waits for another edge of epoll. It would keep
 * the connection until the time limit. Shutting down the reading side creates such an edge; an
 * answer under way still goes out.
 */
static void notice_client_end(const struct orl_connection *one)
{
    char next;
    if (recv(one->fd, &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0)
        shutdown(one->fd, SHUT_RD);
}

/* Returns the bytes read from the connection and the bytes that are still unread. */
static bool count_read(const struct orl_connection *one, uint64_t *ret_taken, uint64_t *ret_unread)
{
    struct tcp_info info = {0};
    socklen_t size = sizeof info;
    int unread = 0;
    if (getsockopt(one->fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 ||
        ioctl(one->fd, SIOCINQ, &unread) != 0)
        return false;
    *ret_taken = (uint64_t)info.tcpi_bytes_received - (uint64_t)unread;
    *ret_unread = (uint64_t)unread;
    return true;
}

/*
 * Returns true if the client keeps sending data that is not body. Between two sweeps the amount of
 * body has not changed. In addition, either bytes lie unread although the connection is not
 * suspended, or more bytes were read than a chunk's first line has. It must hold twice in a row,
 * since a sweep may come just before bytes are read.
 */
static bool is_stuck(struct orl_connection *one)
{
    enum { LINE = 256 };
    uint64_t taken, unread;
    if (!count_read(one, &taken, &unread))
        return false;
    const bool got_on = one->received != one->swept || one->swept_taken == UINT64_MAX;
    if (got_on)
        one->swept_taken = taken;
    one->swept = one->received;
    const bool again = one->stuck;
    one->stuck = !got_on && (unread > 0 || taken > one->swept_taken + LINE);
    return again && one->stuck;
}

static void cut_connection(struct orl_connections *all, struct orl_connection *one)
{
    /* libmicrohttpd owns the descriptor; it finds the connection ended and closes it. */
    shutdown(one->fd, SHUT_RDWR);
    one->awaited = AWAITS_NOTHING;
    all->cut++;
}

void orl_connection_cut(struct MHD_Connection *connection)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    if (info)
        shutdown(info->connect_fd, SHUT_RDWR);
}

/* Returns true while libmicrohttpd parses the headers of a request: they are complete, but our
 * handler has not been called and no answer is queued. */
static bool is_being_parsed(const struct orl_connection *one)
{
    return one->awaited == AWAITS_HEADERS &&
           MHD_get_connection_info(one->handle, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE) &&
           !MHD_get_connection_info(one->handle, MHD_CONNECTION_INFO_HTTP_STATUS);
}

#define UNPARSED                                                                                   \
    "{\"type\":\"urn:oriel:error:syntax\",\"title\":\"The request is not valid HTTP\","            \
    "\"status\":400,\"detail\":\"its Content-Length is not a number of bytes, or its cookies "     \
    "take too much memory\"}"

/* Answers on the socket itself; earlier answers have been sent. Later writes of libmicrohttpd fail,
 * so that it closes the connection. */
static void refuse_unparsed(struct orl_connection *one)
{
    char answer[512];
    const int size =
        snprintf(answer, sizeof answer,
                 "HTTP/1.1 400 Bad Request\r\nContent-Type: application/problem+json\r\n"
                 "Content-Length: %zu\r\nConnection: close\r\n"
                 "X-Content-Type-Options: nosniff\r\n\r\n%s",
                 sizeof UNPARSED - 1, UNPARSED);
    const union MHD_ConnectionInfo *tls =
        MHD_get_connection_info(one->handle, MHD_CONNECTION_INFO_GNUTLS_SESSION);
    const ssize_t sent = tls ? gnutls_record_send(tls->tls_session, answer, (size_t)size)
                             : send(one->fd, answer, (size_t)size, MSG_DONTWAIT | MSG_NOSIGNAL);
    /* A client that has not read earlier answers gets only the end of the connection. */
    shutdown(one->fd, sent == size ? SHUT_WR : SHUT_RDWR);
    one->awaited = AWAITS_NOTHING;
}

void orl_connections_refuse_unparsed(struct orl_connections *all)
{
    for (struct orl_connection *one = all->first; MHD_VERSION < 0x01000000 && one; one = one->next)
        if (is_being_parsed(one))
            refuse_unparsed(one);
}

/* Cuts a connection that libmicrohttpd did not read between two checks, although data was ready. */
static void check_unread(struct orl_connections *all, struct orl_connection *one)
{
    uint64_t taken = 0, unread = 0;
    if (one->awaited != AWAITS_BODY || one->held_s > 0 || !count_read(one, &taken, &unread) ||
        unread == 0) {
        one->left = 0;
        return;
    }
    if (one->left > 0 && one->left == taken)
        cut_connection(all, one);
    one->left = taken;
}

void orl_connections_cut_stuck(struct orl_connections *all)
{
    static const double every_s = 0.01;
    const double now_s = orl_time_steady_s();
    if (now_s - all->checked_s < every_s)
        return;
    all->checked_s = now_s;
    for (struct orl_connection *one = all->first; one; one = one->next)
        check_unread(all, one);
}

void orl_connections_sweep(struct orl_connections *all)
{
    const double now_s = orl_time_steady_s();
    for (struct orl_connection *one = all->first; one; one = one->next) {
        if (one->awaited == AWAITS_NOTHING || one->held_s > 0)
            continue;
        notice_client_end(one);
        if (one->awaited == AWAITS_BODY && is_stuck(one)) {
            cut_connection(all, one);
            continue;
        }
        if (now_s < one->until_s)
            continue;
        if (one->awaited == AWAITS_BODY &&
            (double)one->received >= ORL_SERVER_BODY_RATE * (now_s - one->since_s))
            continue;
        cut_connection(all, one);
    }
}
