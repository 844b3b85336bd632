/*
 * Clients and their work in progress. Bounds keep one client from using all resources.
 *
 * A client is a token, by its id: a token made later with the same name is another client. If
 * tokens are not required, all requests come from programs of this machine over loopback. They form
 * one client by address (IPv6: the /64 network), which may use all that the daemon has.
 *
 * Threads: the loop thread only, except for the quota of bytes (quota.h).
 */
#ifndef ORL_SERVER_HTTP_QUOTA_CLIENTS_H
#define ORL_SERVER_HTTP_QUOTA_CLIENTS_H

#include <stdbool.h>
#include <stddef.h>

#include "http/quota/quota.h"

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
