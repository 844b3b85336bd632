/*
 * Clients, and what each of them has under way: bounds that keep one from taking all there is.
 *
 * A client is a token, by its id: a token made later with the same name is another client. Where
 * none are needed, only programs of this machine come in, all from loopback: they are one client by
 * its address (of IPv6 the network, /64), which may have all that the daemon has to give.
 *
 * Threads: the loop thread only, but for the room of bytes (hold.h).
 */
#ifndef ORL_SERVER_HTTP_CLIENTS_H
#define ORL_SERVER_HTTP_CLIENTS_H

#include <stdbool.h>
#include <stddef.h>

#include "http/hold.h"

struct orl_client {
    char name[80]; /* "token:ID" or "address:..." */
    unsigned refs;
    struct orl_room bytes; /* of its uploads in flight */
    unsigned streams;      /* of events, open */
    struct orl_client *next;
};

struct orl_clients {
    struct orl_client *first; /* those who have something under way */
};

struct orl_request;

/* Whose request it is, with one reference more. NULL: out of memory. */
struct orl_client *orl_client_ref(struct orl_request *request);
void orl_client_unref(struct orl_clients *clients, struct orl_client *client); /* NULL is fine */

/* May the client have another event stream, job? Otherwise false, with a 429 made. */
bool orl_client_may_stream(struct orl_request *request);
bool orl_client_may_queue(struct orl_request *request);

#endif
