/* Quotas for bytes in flight (quota.c), and clients with their work in progress (clients.c). */
#ifndef ORL_SERVER_HTTP_QUOTA_QUOTA_H
#define ORL_SERVER_HTTP_QUOTA_QUOTA_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

/*
 * Quotas for bytes in flight: the disk space of request bodies, and of files unpacked from them,
 * before they are stored. They count against the storage budget (storage.h), and no client may use
 * all of it.
 *
 * A quota is a limit and the bytes reserved below it. A reservation is one request's share of two
 * quotas; it grows until the request ends.
 *
 * Threads: a quota's any; a reservation's one at a time.
 */

struct orl_quota {
    atomic_uint_least64_t reserved, most;
};

enum orl_quota_refusal { ORL_QUOTA_FITS, ORL_QUOTA_FULL, ORL_QUOTA_CLIENT_FULL };

struct orl_reservation {
    struct orl_quota *all, *own; /* all clients' and this client's; NULL: no bound */
    uint64_t bytes;
    enum orl_quota_refusal refused; /* why the last orl_reservation_grow failed */
};

/* Reserves bytes more. ORL_ERR_FULL, with reservation->refused set, if they do not fit. With NULL
 * every reservation succeeds. */
int orl_reservation_grow(struct orl_reservation *reservation, uint64_t bytes,
                         struct orl_error *err);
/* Releases the whole reservation. */
void orl_reservation_release(struct orl_reservation *reservation);

/*
 * Clients and their work in progress. Bounds keep one client from using all resources.
 *
 * A client is a token, by its id: a token made later with the same name is another client. If
 * tokens are not required, all requests come from programs of this machine over loopback. They form
 * one client by address (IPv6: the /64 network), which may use all that the daemon has.
 *
 * Threads: the loop thread only, except for the quota of bytes.
 */

struct orl_client {
    char name[80]; /* "token:ID" or "address:..." */
    unsigned refs;
    struct orl_quota bytes; /* quota of uploads in flight */
    unsigned streams;       /* open event streams */
    struct orl_client *next;
};

struct orl_clients {
    struct orl_client *first; /* clients with work in progress */
};

struct orl_request;

/* Returns the request's client, with its reference count increased. NULL: out of memory. */
struct orl_client *orl_client_ref(struct orl_request *request);
void orl_client_unref(struct orl_clients *clients, struct orl_client *client); /* NULL is allowed */

/* Return true if the client may open another event stream, or queue another job. Otherwise return
 * false, with a 429 made. */
bool orl_client_may_stream(struct orl_request *request);
bool orl_client_may_queue(struct orl_request *request);

#endif
