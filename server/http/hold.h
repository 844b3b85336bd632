/*
 * Bytes in flight: what bodies of requests and files unpacked from them take on the disk before
 * they are kept. They count against the storage budget (storage.h), and no client may have all of
 * it (clients.h).
 *
 * A room says how much there may be, and how much there is. A hold is one request's part of two
 * rooms, and grows until the request ends.
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
    struct orl_room *all, *own; /* the daemon's, the client's; NULL: no bound */
    uint64_t bytes;
    enum orl_hold_refusal refused; /* what take met last */
};

/* ORL_ERR_FULL, with hold->refused, where it does not fit. NULL is no hold: it takes all. */
int orl_hold_take(struct orl_hold *hold, uint64_t bytes, struct orl_error *err);
/* All of it. */
void orl_hold_give_back(struct orl_hold *hold);

#endif
