/*
 * Quotas for bytes in flight: the disk space of request bodies, and of files unpacked from them,
 * before they are stored. They count against the storage budget (storage.h), and no client may use
 * all of it (clients.h).
 *
 * A room is a quota: its limit and the bytes reserved. A hold is one request's reservation in two
 * rooms; it grows until the request ends.
 *
 * Threads: a room's any; a hold's one at a time.
 */
#ifndef ORL_SERVER_HTTP_HOLD_H
#define ORL_SERVER_HTTP_HOLD_H

#include <stdatomic.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_room {
    atomic_uint_least64_t held, most;
};

enum orl_hold_refusal { ORL_HOLD_FITS, ORL_HOLD_NO_ROOM, ORL_HOLD_OWN_SHARE };

struct orl_hold {
    struct orl_room *all, *own; /* all clients' and this client's; NULL: no bound */
    uint64_t bytes;
    enum orl_hold_refusal refused; /* why the last orl_hold_take failed */
};

/* Reserves bytes more. ORL_ERR_FULL, with hold->refused set, if they do not fit. With NULL every
 * reservation succeeds. */
int orl_hold_take(struct orl_hold *hold, uint64_t bytes, struct orl_error *err);
/* Releases the whole reservation. */
void orl_hold_give_back(struct orl_hold *hold);

#endif
