/*
 * Open connections, and patience with them.
 *
 * libmicrohttpd closes a connection that is silent for the idle time-out. A client that sends a
 * byte now and then is never silent; so headers must be complete within ORL_SERVER_HEADER_S of the
 * connection's start (of an earlier answer: within the idle time-out), and a body must come, on
 * average and once the idle time-out is over, at ORL_SERVER_BODY_RATE at least. Who is slower is
 * cut off, without an answer. So is who sends, in place of a body, what is none: a chunk's first
 * line that is longer than libmicrohttpd has room for, which looks at it again and again, all 32
 * kB, and would have the loop do nothing else: that one goes at once (orl_connections_look). Who
 * waits for an answer, or takes one in, is bounded by silence and by the number of connections
 * alone; the time that a body waits for us is not held against its client.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_CONNECTIONS_H
#define ORL_SERVER_HTTP_CONNECTIONS_H

#include <microhttpd.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

enum { ORL_ADDRESS_BUCKETS = 256 };

struct orl_connections {
    struct orl_connection *first;
    struct orl_address *addresses[ORL_ADDRESS_BUCKETS]; /* that have any open */
    unsigned most;                                      /* of one address */
    size_t open, unwatched;  /* unwatched: opened without memory for an entry */
    uint64_t started;        /* ever; a connection's serial number is this at its start */
    uint64_t cut;            /* for slowness, ever */
    double idle_s, looked_s; /* looked_s: when orl_connections_look did last */
};

/* MHD's callback; the closure is the struct orl_connections. */
void orl_connections_notify(void *connections, struct MHD_Connection *connection, void **context,
                            enum MHD_ConnectionNotificationCode code);

/*
 * The smallest serial number of a connection that has not brought a request yet: its TLS handshake
 * may be under way. Without such: one more than the newest connection's. 0: unknown.
 */
uint64_t orl_connections_oldest_handshake(const struct orl_connections *connections);

/* MHD's other: may that address have another one? IPv6 addresses count by their network, /64. */
enum MHD_Result orl_connections_allow(void *connections, const struct sockaddr *address,
                                      socklen_t size);

/* A request's headers are there: its body is awaited, if any. */
void orl_connection_headers(struct MHD_Connection *connection);
/* So much of its body has come. */
void orl_connection_received(struct MHD_Connection *connection, size_t bytes);
/* It waits for us from here on, suspended; and comes on. */
void orl_connection_hold(struct MHD_Connection *connection);
void orl_connection_go_on(struct MHD_Connection *connection);
/* All of it is there: nothing is awaited. */
void orl_connection_body(struct MHD_Connection *connection);
/* It brings what libmicrohttpd would give no answer to: it ends now. */
void orl_connection_cut(struct MHD_Connection *connection);
/*
 * To be called when libmicrohttpd logs something. Versions before 1.0 answer complete headers that
 * they cannot parse (a Content-Length that is no number, cookies beyond their memory) with two
 * header blocks in one response. The connection that this happens to gets an answer of ours
 * instead, and no more can be sent to it.
 */
void orl_connections_refuse_unparsed(struct orl_connections *connections);
/* The request is over; the connection may bring another. */
void orl_connection_over(struct MHD_Connection *connection);

/* Cuts off who sends what libmicrohttpd has no room for, when it was not read between two looks. To
 * be called by a loop that finds no rest, after all that is ready has been run once. */
void orl_connections_look(struct orl_connections *connections);

/* Cuts off who is too slow, or has hung up. To be called every second or so. */
void orl_connections_sweep(struct orl_connections *connections);

#endif
