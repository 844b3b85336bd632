/*
 * Open connections, their time limits for slow clients and the keys of their addresses
 * (connections.c), and the certificate of HTTPS (tls.c).
 */
#ifndef ORL_SERVER_HTTP_CONNECTION_CONNECTIONS_H
#define ORL_SERVER_HTTP_CONNECTION_CONNECTIONS_H

#include <microhttpd.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <sys/socket.h>

/*
 * Time limits for slow clients.
 *
 * libmicrohttpd closes a connection that is silent for the idle timeout. A client that sends a byte
 * now and then is never silent, so two more limits hold. Headers must be complete within
 * ORL_SERVER_HEADER_S of the connection's start; after an earlier answer, within the idle timeout.
 * Once the idle timeout is over, a body must arrive at ORL_SERVER_BODY_RATE or faster on average. A
 * slower client is cut off without an answer.
 *
 * A client that sends something other than a body is also cut off. An example is a chunk's first
 * line that is longer than libmicrohttpd's buffer. libmicrohttpd would parse its 32 kB again and
 * again and keep the loop busy, so that connection is cut at once (orl_connections_cut_stuck).
 *
 * While a client waits for an answer or receives one, only silence and the number of connections
 * are bounded. The time that a body waits for the daemon does not count against its client.
 *
 * Threads: the loop thread only.
 */

enum { ORL_ADDRESS_BUCKETS = 256 };

struct orl_connections {
    struct orl_connection *first;
    struct orl_address *addresses[ORL_ADDRESS_BUCKETS]; /* addresses with open connections */
    unsigned most;                                      /* maximum of one address */
    size_t open, unwatched;   /* unwatched: opened without memory for an entry */
    uint64_t started;         /* total so far; the serial number of the newest connection */
    uint64_t cut;             /* total cut off for slowness */
    double idle_s, checked_s; /* checked_s: time of the last orl_connections_cut_stuck */
};

/* MHD's connection callback; the closure is the struct orl_connections. */
void orl_connections_notify(void *connections, struct MHD_Connection *connection, void **context,
                            enum MHD_ConnectionNotificationCode code);

/*
 * Returns the smallest serial number of a connection that has not sent a request yet: its TLS
 * handshake may be under way. If there is none, returns one more than the newest connection's
 * number. 0: unknown.
 */
uint64_t orl_connections_oldest_handshake(const struct orl_connections *connections);

/* MHD's accept callback: returns MHD_YES if the address may open another connection. IPv6 addresses
 * count by their /64 network. */
enum MHD_Result orl_connections_allow(void *connections, const struct sockaddr *address,
                                      socklen_t size);

/* A request's headers are complete; the body is awaited, if any. */
void orl_connection_headers_complete(struct MHD_Connection *connection);
/* Counts received bytes of the body. */
void orl_connection_received(struct MHD_Connection *connection, size_t bytes);
/* suspend: the connection is suspended and waits for the daemon. resume: it resumes. */
void orl_connection_suspend(struct MHD_Connection *connection);
void orl_connection_resume(struct MHD_Connection *connection);
/* The body is complete; nothing more is awaited. */
void orl_connection_body_complete(struct MHD_Connection *connection);
/* Ends a connection at once: its data would get no answer from libmicrohttpd. */
void orl_connection_cut(struct MHD_Connection *connection);
/*
 * Answers a request whose headers libmicrohttpd cannot parse. Call it when libmicrohttpd logs a
 * message. Versions before 1.0 answer such complete headers (a Content-Length that is no number,
 * cookies beyond their memory) with two header blocks in one response. The connection gets this
 * answer instead, and nothing more can be sent to it.
 */
void orl_connections_refuse_unparsed(struct orl_connections *connections);
/* The request is complete; the connection may send another. */
void orl_connection_end_request(struct MHD_Connection *connection);

/* Cuts off clients whose data does not fit libmicrohttpd's buffer: it was not read between two
 * calls. Call it from a loop that stays busy, after everything that is ready has run once. */
void orl_connections_cut_stuck(struct orl_connections *connections);

/* Cuts off clients that are too slow or have disconnected. Called about every second. */
void orl_connections_sweep(struct orl_connections *connections);

/* Keys of the addresses that connections come from. */

enum { ORL_ADDRESS_KEY = 64 };

/*
 * Writes the key of an address's owner as text. For IPv6 it is the /64 network, since a subscriber
 * can choose any address of it. For IPv4, also when mapped into IPv6, it is the address.
 */
void orl_address_key(const struct sockaddr *address, char ret_key[ORL_ADDRESS_KEY]);

/*
 * Certificate and private key of HTTPS. GnuTLS asks for them with every handshake, so they can be
 * replaced while the daemon runs. Replaced ones stay until the handshakes under way are over.
 *
 * Threads: the loop thread only. One per process: GnuTLS's callback has no closure.
 */

struct orl_certificate;

struct orl_tls {
    struct orl_certificate *current; /* NULL: none */
};

/* Protocols of GnuTLS: TLS 1.2 and 1.3, with its default choice of strong ciphers. */
#define ORL_TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:%SERVER_PRECEDENCE"

/*
 * Reads both PEM files, and serves them from now on; invalid ones change nothing. A key that every
 * user of the machine can read is refused, and so is a key that does not match the certificate.
 * newest_connection: serial number of the last connection that may use the previous certificate.
 */
int orl_tls_load(struct orl_tls *tls, const char *cert_path, const char *key_path,
                 uint64_t newest_connection, struct orl_error *err);
/* Frees the certificates that were replaced before any connection from oldest_handshake on. */
void orl_tls_free_older(struct orl_tls *tls, uint64_t oldest_handshake);
void orl_tls_done(struct orl_tls *tls); /* wipes the keys; a zeroed struct is allowed */

/* Returns the value for MHD_OPTION_HTTPS_CERT_CALLBACK, as a number. */
uintptr_t orl_tls_callback(void);

#endif
